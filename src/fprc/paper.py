"""The paper's vocabulary: what it names by key, and how a reader knows it."""

#: The two hysteresis experiments: in Table II the first trains and the second tests, in Table III
#: the other way round.
EXPERIMENTS = ("sweep", "complex")

#: Tables II and III: the log that trains, and the log that tests.
DIRECTIONS = (EXPERIMENTS, EXPERIMENTS[::-1])

#: The references of Table IV.
REFERENCES = ("sine_0p2", "sine_0p5", "sweep", "complex")

#: That of the disturbance test, Fig. 17.
DISTURBANCE = "disturbance"

#: Gains of the PD controller, by name: the paper's, and the one that was identified.
GAINS = ("printed", "identified")

#: Controllers of the closed-loop runs, with the gain that PD has.
CONTROLLERS = (
    "fprc",
    "fprc_pd_printed",
    "fprc_pd_identified",
    "pd_printed",
    "pd_identified",
)

#: Models of each grid of Figs. 10 and 11, and the settings that it changes.
GRID_MODELS = {"epsilon": ("fprc",), "n_c": ("fprc", "fuzzy_linear"), "taps": ("fprc",)}
GRID_SETTINGS = {"epsilon": ("epsilon",), "n_c": ("n_c",), "taps": ("n_u", "n_y")}

#: What a log's ``source`` means to a reader.
SOURCES = {
    "sim": "simulated rig, not hardware",
    "rig": "recorded on the rig",
    "import": "imported recordings",
    "rig+sim": "recorded on the rig, P_o simulated, driven by the recorded theta",
    "import+sim": "imported recordings, P_o simulated, driven by the recorded theta",
}

REFERENCE_NAMES = {
    "sine_0p2": "Sine 0.2 Hz",
    "sine_0p5": "Sine 0.5 Hz",
    "sweep": "Sweep",
    "complex": "Complex",
    "disturbance": "Sine 0.3 Hz, disturbed",
}

#: Where ``config/published.yaml`` has the errors, by the log that trained.
PRINTED = {"sweep": "table_2_models", "complex": "table_3_reversed"}

ERRORS = {
    "train_rmse": "Training RMSE",
    "validation_rmse": "Validation RMSE",
    "test_rmse": "Test RMSE",
}


def controller_and_gain(name: str) -> tuple[str, str]:
    """Return what a log calls ``controller`` and ``gain``: fprc_pd and printed, fprc and none."""
    for gain in GAINS:
        if name.endswith(f"_{gain}"):
            return name.removesuffix(f"_{gain}"), gain
    return name, "none"


def run_log(reference: str, controller: str) -> str:
    """Return the name of the log of one closed-loop run."""
    return f"track_{reference}_{controller}"


def reference_and_controller(log: str) -> tuple[str, str]:
    """Return what ``run_log`` made a name of."""
    for reference in (*REFERENCES, DISTURBANCE):
        if log.startswith(run_log(reference, "")):
            return reference, log.removeprefix(run_log(reference, ""))
    raise ValueError(f"{log} is no closed-loop run")
