"""Settings of the comparison beyond the paper."""

from typing import Annotated

from pydantic import field_validator

from fprc.config.section import Pair, Section, quantities, quantity, rising, within


class Disturbances(Section):
    """What is done to P_o of the test log after training."""

    shifts_kpa: tuple[Annotated[float, within(-100, 100)], ...] = quantities(
        (-5, -3, -2, -1, 0, 1, 2, 3, 5), "kPa", (-100, 100), "constant shifts of P_o"
    )
    drift_kpa: float = quantity(2.0, "kPa", (0, 100), "steady fall of P_o over the test log")
    noise_kpa: float = quantity(
        1.0, "kPa", (0, 100), "standard deviation of white noise added to P_o"
    )


class TrainingLogs(Section):
    """Training logs of other lengths, and a second one."""

    seeds: int = quantity(10, "-", (1, 1000), "seeds")
    seconds: tuple[Annotated[float, within(5, 3600)], ...] = quantities(
        (15, 30, 60, 120, 240), "s", (5, 3600), "lengths; each sweeps over the whole band"
    )
    second_f_hz: tuple[Annotated[float, within(0.001, 10)], ...] = quantities(
        (0.18, 0.07, 0.43, 0.23, 0.37), "Hz", (0.001, 10),
        "frequencies of a second training log, a multisine as the test log is",
    )  # fmt: skip


class Tuning(Section):
    """Choice of the competitors' settings, on seeds and rigs that judge nothing else."""

    candidates: int = quantity(24, "-", (1, 10000), "settings tried per model, the defaults first")
    units: int = quantity(3, "-", (1, 100), "seeds of a world, or rigs of it")
    seed: int = quantity(1, "-", (0, 2**31), "seed of the draws")


class Capacity(Section):
    """Memory and information processing capacity of the reservoir, on random holds of theta_d."""

    seeds: int = quantity(10, "-", (1, 1000), "seeds of each rig")
    hold_s: float = quantity(
        0.5, "s", (0.01, 60), "length of a hold; two in a period of the fastest paper signal"
    )
    angle_range_deg: Pair[Annotated[float, within(-120, 120)]] = quantities(
        (5, 60), "deg", (-120, 120), "theta_d of a hold is uniform in this range"
    )
    samples: int = quantity(4000, "-", (100, 1_000_000), "holds that are judged")
    washout: int = quantity(20, "-", (0, 10000), "holds before them")
    max_delay: int = quantity(10, "holds", (1, 1000), "longest delay of a target")
    max_degree: int = quantity(3, "-", (1, 10), "highest total degree of a target")
    p: float = quantity(
        1e-4, "-", (1e-12, 0.5), "probability that a capacity of chance counts, per target"
    )
    virtual_nodes: int = quantity(10, "-", (1, 1000), "samples of P_o in a hold")
    bank_epsilons: tuple[Annotated[float, within(1e-6, 1)], ...] = quantities(
        (0.03, 0.01, 0.003), "-", (1e-6, 1), "filter factors of the bank of low-passes"
    )
    esn_nodes: int = quantity(100, "-", (1, 10000), "nodes of the ESN")

    _rises = field_validator("angle_range_deg")(rising)


class Beyond(Section):
    """Competitors of the paper's models on several worlds: rigs, and sets of rigs."""

    first_seed: int = quantity(
        601, "-", (0, 2**31 - 2**20), "the worlds' seeds count from here; no fit has seen them"
    )
    seeds: int = quantity(40, "-", (1, 10000), "seeds of each world with one rig")
    rigs: int = quantity(40, "-", (1, 10000), "rigs of each world with many")
    seeds_per_rig: int = quantity(3, "-", (1, 100), "seeds of each drawn rig")
    slow: int = quantity(
        20, "-", (0, 10000), "seeds that also judge the slow models (ESN, trees, MLP)"
    )
    restarts: int = quantity(
        10, "-", (1, 1000), "starts of every clustering; the lowest objective is kept"
    )
    disturbances: Disturbances = Disturbances()
    training: TrainingLogs = TrainingLogs()
    tuning: Tuning = Tuning()
    capacity: Capacity = Capacity()
