"""Settings of the comparison beyond the paper."""

from fprc.config.section import NotEmpty, Rising, Section, quantity


class Capacity(Section):
    """Memory and information processing capacity of the reservoir, with theta_d held at random."""

    seeds: int = quantity(10, (1, 1000), "seeds of each rig")
    hold_s: float = quantity(
        0.5, (0.01, 60), "length of a hold; half a period of the paper's fastest signal"
    )
    angle_range_deg: Rising[float] = quantity(
        (5, 60), (-120, 120), "theta_d of each hold is drawn uniformly from this range"
    )
    samples: int = quantity(4000, (100, 1_000_000), "holds that are evaluated")
    washout: int = quantity(20, (0, 10000), "holds before these that are discarded")
    max_delay: int = quantity(10, (1, 1000), "longest delay of a target", unit="holds")
    max_degree: int = quantity(3, (2, 4), "highest total degree of a target")
    p: float = quantity(
        1e-4, (1e-12, 0.5), "probability, per target, that a capacity due to chance counts"
    )
    virtual_nodes: int = quantity(10, (1, 1000), "samples of P_o in a hold")
    bank_epsilons: NotEmpty[float] = quantity(
        (0.03, 0.01, 0.003), (1e-6, 1), "filter factors of the bank of low-passes"
    )
    esn_nodes: int = quantity(100, (1, 4000), "nodes of the ESN")


class OnlineStudy(Section):
    """The study of a model that learns while it runs."""

    first_seed: int = quantity(1001, (0, 2**31 - 2**20), "first seed, and seed of the models")
    units: int = quantity(10, (1, 1000), "seeds of each named rig; rigs of each family of many")


class Beyond(Section):
    """Competitors of the paper's models on several families: of one rig, or of many."""

    first_seed: int = quantity(
        601, (0, 2**31 - 2**20), "first seed of the families; no fit has seen it or a later one"
    )
    seeds: int = quantity(40, (1, 10000), "seeds of each family with one rig")
    rigs: int = quantity(40, (1, 10000), "rigs of each family with many")
    seeds_per_rig: int = quantity(3, (1, 100), "seeds of each drawn rig")
    slow: int = quantity(
        10, (0, 10000), "seeds that also judge slow models of no claim (ESN, trees, MLP)"
    )
    restarts: int = quantity(
        10, (1, 1000), "starts of every clustering; the lowest objective is kept"
    )
    shifts_kpa: NotEmpty[float] = quantity(
        (-5, -3, -2, -1, 0, 1, 2, 3, 5), (-100, 100), "constant shifts of P_o after the training"
    )
    capacity: Capacity = Capacity()
