"""Names, as a reader knows them, of what the results call by key."""

#: Printed name of each model, in the paper's order.
MODEL_NAMES = {"esn": "ESN", "fprc": "FPRC", "fuzzy_linear": "Fuzzy-linear"}


#: What a log's ``source`` means to a reader.
SOURCES = {
    "sim": "simulated rig, not hardware",
    "rig": "recorded on the rig",
    "import": "imported recordings",
    "rig+sim": "recorded on the rig, P_o simulated, driven by the recorded theta",
    "import+sim": "imported recordings, P_o simulated, driven by the recorded theta",
}


CONTROLLER_NAMES = {"fprc": "FPRC", "fprc_pd": "FPRC+PD", "pd": "PD"}


REFERENCE_NAMES = {
    "sine_0p2": "Sine 0.2 Hz",
    "sine_0p5": "Sine 0.5 Hz",
    "sweep": "Sweep",
    "complex": "Complex",
    "disturbance": "Sine 0.3 Hz, disturbed",
}


#: Where ``config/published.yaml`` has the errors, by the log that trained.
PRINTED = {"sweep": "table_2_models", "complex": "table_3_reversed"}


ERRORS = {"train_rmse": "Training RMSE", "validation_rmse": "Validation RMSE",
           "test_rmse": "Test RMSE"}  # fmt: skip
