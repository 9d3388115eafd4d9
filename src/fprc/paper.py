"""The paper's names: keys in code, configuration and files, and the names shown to readers."""

from pathlib import Path

#: The numbers that the paper prints.
PUBLISHED = Path(__file__).parent / "config/published.yaml"

#: The two hysteresis experiments: in Table II the first trains and the second tests, in Table III
#: the other way round.
EXPERIMENTS = ("sweep", "complex")
#: The models of Tables II and III, as the claims and the calibration compare them.
MODELS = ("esn", "fprc", "fuzzy_linear")
#: Tables II and III: the log that trains, and the log that tests.
DIRECTIONS = (EXPERIMENTS, EXPERIMENTS[::-1])
#: The references of Table IV.
REFERENCES = ("sine_0p2", "sine_0p5", "sweep", "complex")
#: The references on which Fig. 16 compares PD alone with FPRC+PD.
LOOPS = ("sine_0p5", "sweep")
#: The reference of the disturbance test, Fig. 17.
DISTURBANCE = "disturbance"
#: Controllers of the closed-loop runs.
CONTROLLERS = ("fprc", "fprc_pd", "pd")
#: Models of each grid of Figs. 10 and 11, and the settings that the grid varies.
GRID_MODELS = {"epsilon": ("fprc",), "n_c": ("fprc", "fuzzy_linear"), "taps": ("fprc",)}
GRID_SETTINGS = {"epsilon": ("epsilon",), "n_c": ("n_c",), "taps": ("n_u", "n_y")}
#: A log's ``source``, spelt out for readers.
SOURCES = {
    "sim": "simulated rig, not hardware",
    "rig": "recorded on the rig",
    "import": "imported recordings",
}
REFERENCE_NAMES = {
    "sine_0p2": "Sine 0.2 Hz",
    "sine_0p5": "Sine 0.5 Hz",
    "sweep": "Sweep",
    "complex": "Complex",
    "disturbance": "Sine 0.3 Hz, disturbed",
}
#: Sections of ``published.yaml`` with the printed errors, by training log.
PRINTED = {"sweep": "table_2_models", "complex": "table_3_reversed"}
ERRORS = {
    "train_rmse": "Training RMSE",
    "validation_rmse": "Validation RMSE",
    "test_rmse": "Test RMSE",
}


def run_log(reference: str, controller: str) -> str:
    """Return the name of the log of one closed-loop run."""
    return f"track_{reference}_{controller}"


def reference_and_controller(log: str) -> tuple[str, str]:
    """Return reference and controller of a closed-loop run, given the name of its log."""
    for reference in (*REFERENCES, DISTURBANCE):
        if log.startswith(run_log(reference, "")):
            return reference, log.removeprefix(run_log(reference, ""))
    raise ValueError(f"{log} is no closed-loop run")
