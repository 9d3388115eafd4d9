"""Multiplications of the models' equations, the part of their speed that no processor changes."""

from fprc.models import EchoStates, RidgeReadout, SequenceModel, TakagiSugenoReadout, TapFeatures


def multiplications(model: SequenceModel, phase: str, samples: int) -> int | None:
    """Return how many multiplications a log takes in training or test, by the equations.

    Divisions and exponentials count too. Fuzzy c-means counts with the iterations that it took.
    Drawing the ESN's weights does not count. Other features or another readout than those of the
    paper's models give None.
    """
    features, readout = model.features_, model.readout_
    inputs, size = features.n_features_in_, readout.n_features_in_
    if isinstance(features, EchoStates):
        mapped = features.r * (features.r + inputs + 2)  # W_r x, w_in theta, leak
    elif isinstance(features, TapFeatures):
        mapped = inputs - features.count_references()  # low-passes
    else:
        return None
    weights = 1 + size
    # X^T X is symmetric, and solved by Cholesky's method
    sums, solution = weights * (weights + 1) // 2 + weights, weights**3 // 6
    if isinstance(readout, RidgeReadout):
        output, fit = size, samples * sums + solution
    elif isinstance(readout, TakagiSugenoReadout):
        rules = readout.n_c
        output = rules * (2 * size + 3) + 1  # distances, memberships, rules, their mean
        passes = round(readout.passes * samples) * rules * (2 * size + 3)
        fit = passes + rules * (samples * (weights + sums) + solution)
    else:
        return None
    return samples * mapped + (fit if phase == "train" else samples * output)
