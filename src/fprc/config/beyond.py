"""Settings of the studies behind the paper."""

from fprc.config.section import Section, quantity


# fmt: off
class Beyond(Section):
    """Competitors of the paper's models on several families of rigs, and other studies of these."""

    first_seed: int = quantity(601, (0, 2**31 - 2**20),
        "first seed of the families; no fit has seen it or a later one")
    units: int = quantity(15, (1, 10000),
        "seeds of each family with one rig, and rigs of each family with many")
    slow: int = quantity(4, (1, 10000),
        "units that also judge slow models of no claim: ESN, trees, MLP")
    restarts: int = quantity(10, (1, 1000),
        "starts of every clustering; the lowest objective is kept")
