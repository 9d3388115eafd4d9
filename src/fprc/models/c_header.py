"""A fitted model as a C header, for a controller without Python."""

import json
import re
from pathlib import Path
from string import Template

import numpy as np
from sklearn.utils.validation import check_is_fitted

from fprc.control_laws import FARTHEST_DEG, LARGEST_ERROR_DEG
from fprc.errors import FprcError
from fprc.limits import LARGEST
from fprc.models.features import TapFeatures, rows_of
from fprc.models.fprc import TakagiSugenoReadout
from fprc.models.online import Online
from fprc.models.ridge import RidgeReadout
from fprc.models.sequence import SequenceModel


def c_header(
    model: SequenceModel, name: str, *, origin: str = "", online: Online | None = None
) -> str:
    """Return a C header that computes what ``model.step`` computes, see docs/deploy.md.

    The fitted ``model`` has taps, low-passes and plays as features, alone or side by side, and a
    ridge or a fuzzy readout (Sec. III-B, Eqs. 4, 6, 10-12). ``name`` begins every name in the
    header; ``origin``, where the model comes from, is for its comment. With ``online``, the same
    model as it learns, it has ``NAME_learn(&state, error, theta)`` and ``NAME_sent(&state, p_fb)``.

    FprcError: the model cannot be exported, or ``name`` is no C name.
    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise FprcError(
            f"{name!r} cannot begin names in C; use letters, digits and _, with a letter first"
        )
    check_is_fitted(model)
    rows, readout = rows_of(model.features_), model.readout_
    if not rows or not isinstance(readout, RidgeReadout | TakagiSugenoReadout):
        raise FprcError(
            f"{type(model).__name__} cannot be exported; C code exists only for taps, low-passes "
            "and plays, alone or side by side, with a ridge or a fuzzy readout"
        )
    columns, kinds, numbers = zip(*rows, strict=True)
    if isinstance(readout, RidgeReadout):  # a fuzzy readout of one rule
        equation = "P_ff(k) = w_out [1, x(k)], paper, Eq. (4)"
        weights, centers, sigma = readout.w_out_[None], np.zeros((1, len(rows))), 1.0
    else:
        equation = "P_ff(k) = beta_bar(k) W_out [1, x(k)], paper, Eq. (12)"
        weights, centers, sigma = readout.W_out_, readout.centers_, readout.sigma
    sizes = {"INPUTS": model.n_features_in_, "ROW": len(rows), "RULES": len(weights)}
    tables = {"column": columns, "kind": kinds, "number": numbers, "largest": LARGEST}
    tables |= {"centers": centers, "weights": weights[:, 1:], "half_over_sigma2": 0.5 / sigma**2}
    tables |= {"at_center": weights[:, 0] + np.sum(weights[:, 1:] * centers, axis=1)}
    parameters = ", ".join(f"{key}={value}" for key, value in model.get_params(deep=False).items())
    described, use = f"{type(model).__name__}({parameters})", f"p_ff = {name}_step(&state, x);"
    if online is not None:
        settings = online.settings
        sizes |= {"LEARNS": 1, "WEIGHTS": len(online.prior), "DELAY": online.delay}
        tables |= {"mixing": online.mixing, "most": min(online.limit_kpa, LARGEST)}
        tables |= {"kpa_per_deg": settings.kpa_per_deg, "limit": settings.limit_kpa}
        tables |= {"stop": settings.stop_deg, "prior": online.prior}
        tables |= {"farthest": FARTHEST_DEG, "fastest": online.fastest_deg}
        tables |= {"largest_error": LARGEST_ERROR_DEG}
        described += f", {settings}"
        use = f"{name}_learn(&state, error, theta); {use} {name}_sent(&state, p_fb);"
    code = Path(__file__).with_name("c_header.h").read_text(encoding="utf-8")
    named = code.replace("pff_", f"{name}_").replace("PFF_", f"{name.upper()}_")
    rate = "at the sample rate of the training log and in its units"
    if hasattr(model, "sample_rate_hz_"):
        rate = f"at {model.sample_rate_hz_:.6g} Hz"
    return Template(named).substitute(
        model=_comment(described),
        origin=f"\n * {_comment(origin)}" if origin else "",
        equation=equation,
        inputs="\n".join(_describe_inputs(model)),
        unit=_comment(getattr(model, "units_", ["kPa"])[0]),
        rate=rate,
        use=use,
        sizes="\n".join(f"#define {name.upper()}_{key} {size}" for key, size in sizes.items()),
        tables="\n".join(_table(name, key, np.array(table)) for key, table in tables.items()),
    )


def _describe_inputs(model: SequenceModel) -> list[str]:
    count, features = model.n_features_in_, model.features_
    kinds = [f"column {i} of the training log, counted from 0" for i in range(count)]
    if isinstance(features, TapFeatures):
        kinds = ["theta_d" if i < features.count_references() else "P_o" for i in range(count)]
    units = [f", {unit}" for unit in getattr(model, "units_", [])[1:]] or [""] * count
    names = [f" (column {name})" for name in getattr(model, "feature_names_in_", [])]
    described = zip(kinds, units, names or [""] * count, strict=True)
    return [f" *   x[{i}]: {_comment(''.join(words))}" for i, words in enumerate(described)]


def _comment(text: str) -> str:
    """Return text on one line that cannot end a comment in C."""
    return re.sub(r"[^\w .,:;=()\[\]{}'+-]", "_", " ".join(text.split()), flags=re.ASCII)


def _table(name: str, key: str, table: np.ndarray) -> str:
    """Return the definition of a number or a table in C, without loss."""
    kind = "int" if table.dtype.kind == "i" else f"{name}_real"
    sizes = "".join(f"[{size}]" for size in table.shape)
    text = json.dumps(table.tolist()).replace("], [", "],\n    [")
    values = text.translate(str.maketrans("[]", "{}"))
    return f"static const {kind} {name}_{key}{sizes} = {values};"
