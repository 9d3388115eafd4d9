"""Changes that a program may make to a raw log, or errors when it writes one.

A plausible change gives a valid log of other measurements: one sample a little higher, one more
channel, numbers in single precision. All other changes must be detected.
"""

import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

Change = Callable[[np.random.Generator, h5py.File], str]
_ODD = (np.nan, np.inf, -np.inf, 1e6, -1e6, 1e30, -1e300, 1.7e308)


def change(rng: np.random.Generator, path: Path) -> tuple[str, bool]:
    """Change a log in place; return a description, and whether the result is plausible."""
    plausible = rng.random() < 0.2
    ways = PLAUSIBLE if plausible else WRONG
    way = ways[rng.integers(len(ways))]
    with h5py.File(path, "a") as file:
        description = way(rng, file)
    return description, plausible


def _channel(rng: np.random.Generator, file: h5py.File) -> str:
    return str(rng.choice(sorted(name for name in file if name != "time_s")))


def _rewrite(file: h5py.File, name: str, values: np.ndarray, **how) -> None:
    units = file[name].attrs["units"]
    del file[name]
    file.create_dataset(name, data=values, **how).attrs["units"] = units


# --- valid changes --------------------------------------------------------------------------


def _nudge(rng, file):
    name = _channel(rng, file)
    k = int(rng.integers(len(file[name])))
    file[name][k] *= 1.001
    return f"{name}[{k}] 0.1 % higher"


def _add_channel(rng, file):
    name = str(rng.choice(["humidity_kpa", "spare_v", "foo", "Temperatur °C"]))
    file[name] = np.arange(len(file["time_s"]), dtype=float)
    return f"channel {name} added"


def _single_precision(rng, file):
    name = _channel(rng, file)
    _rewrite(file, name, file[name][:].astype(np.float32))
    return f"{name} in single precision"


def _big_endian(rng, file):
    name = _channel(rng, file)
    _rewrite(file, name, file[name][:].astype(">f8"))
    return f"{name} in big-endian"


def _compressed(rng, file):
    name = _channel(rng, file)
    _rewrite(file, name, file[name][:], compression="gzip", shuffle=True)
    return f"{name} compressed"


def _add_attribute(rng, file):
    value = [7, "someone", 1.5, np.arange(3), np.bytes_(b"abc")][rng.integers(5)]
    file.attrs["remark"] = value
    return f"attribute remark = {value!r}"


def _other_text(rng, file):
    name = str(rng.choice(["experiment", "software"]))
    value = str(rng.choice(["banana", "\x1b[31msweep", "x" * 10000, "Größe", "=1+1"]))
    file.attrs[name] = value
    return f"attribute {name} = {value[:20]!r}"


PLAUSIBLE: tuple[Change, ...] = (
    _nudge, _add_channel, _single_precision, _big_endian, _compressed, _add_attribute, _other_text,
)  # fmt: skip


# --- changes that must be detected ----------------------------------------------------------


def _odd_sample(rng, file):
    name = str(rng.choice(sorted(file)))
    k, value = int(rng.integers(len(file[name]))), float(rng.choice(_ODD))
    file[name][k] = value
    return f"{name}[{k}] = {value}"


def _odd_channel(rng, file):
    name, factor = _channel(rng, file), float(rng.choice([1e5, -1e5, 1e20, 1e200, 1e300, np.nan]))
    file[name][:] = file[name][:] * factor
    return f"{name} times {factor:g}"


def _drop_channel(rng, file):
    needed = {"theta_deg", "p_exp_kpa", "time_s", "theta_d_deg", "p_ff_kpa", "p_fb_kpa"}
    if file.attrs["source"] != b"import":  # optional in imported logs
        needed |= {"p_o_kpa", "valve_main_v", "p_i_command_kpa"}
    name = str(rng.choice(sorted(needed & set(file))))
    del file[name]
    return f"no {name}"


def _rename_channel(rng, file):
    name = str(rng.choice(["theta_deg", "p_exp_kpa", "time_s"]))
    other = str(rng.choice([name.upper(), f"{name} ", f"/x/{name}", "theta", f"\x1b[31m{name}"]))
    file.move(name, other)
    return f"{name} is called {other!r}"


def _units(rng, file):
    name = str(rng.choice(sorted(file)))
    value = [
        b"bar",
        "rad",
        "",
        "\x1b[2Jx",
        1.0,
        np.arange(2),
        np.bytes_(b"\xff\xfe"),
        h5py.Empty("f"),
    ]
    chosen = value[rng.integers(len(value))]
    file[name].attrs["units"] = chosen
    return f"units of {name} = {chosen!r}"


def _kind(rng, file):
    name = str(rng.choice(sorted(file)))
    values = file[name][:]
    n = len(values)
    odd = [
        values.astype(complex), values.astype("S8"), values > 0, values.reshape(2, -1),
        values[:-1], values[:1], values[:0], np.float64(1.0), np.concatenate([values, values]),
        values.reshape(-1, 1).repeat(2, axis=1), np.zeros(n, [("a", "f8"), ("b", "i4")]),
    ]  # fmt: skip
    chosen = odd[rng.integers(len(odd))]
    _rewrite(file, name, chosen)
    return f"{name} is {chosen.dtype} of shape {chosen.shape}"


def _text_channel(rng, file):
    name = _channel(rng, file)
    _rewrite(file, name, [str(value) for value in file[name][:]])
    return f"{name} is text"


def _clock(rng, file):
    values = file["time_s"][:]
    k, way = int(rng.integers(1, len(values))), int(rng.integers(6))
    if way == 0:
        values[k] = values[k - 1]
    elif way == 1:
        values[k:] += float(rng.choice([1.0, 1e6, 1e300]))
    elif way == 2:
        values = values[::-1].copy()
    elif way == 3:
        values *= float(rng.choice([2.0, 1e3, 1e-3, 1e-300, 0.0, -1.0]))
    elif way == 4:
        values[k] = float(rng.choice([np.nan, np.inf, -1e9]))
    else:
        values += 1e18
    file["time_s"][:] = values
    return f"clock, way {way} at {k}"


def _attribute_gone(rng, file):
    name = str(rng.choice(["experiment", "source", "simulated", "sample_rate_hz", "software"]))
    del file.attrs[name]
    return f"attribute {name} gone"


_WRONG_ATTRIBUTES = {
    "experiment": ["", 5, np.bytes_(b"swe\xff\xfep")],
    "source": ["", "moon", 1, np.bytes_(b"\xff"), ["sim", "rig"]],
    "simulated": ["yes", 7, np.array([True, False]), np.bytes_(b"\x00")],
    "sample_rate_hz": [0.0, -200.0, np.nan, np.inf, 1e300, 1e-300, "200", np.array([200.0, 100.0])],
    "seed": ["one", np.nan, 1.5, np.array([1, 2])],
    "software": [1, np.bytes_(b"\xfffprc"), h5py.Empty("S1")],
    "rig": ["{", "5", "[]", "null", 7, np.bytes_(b"{\xff}")],
    "notes": ["{", "5", "[]", "null", '{"p_o_kpa": 5}', '{"p_o_kpa": null}', 7, "[" * 3000],
    "statistics": [5, "5", "[1]", "{", "NaN", '"x"', '{"overruns": NaN}', np.arange(3)],
    "complete": ["no", 5, "false", np.array([True, False])],
    "incomplete_reason": [5, np.bytes_(b"\xff\xfe")],
    "lost_samples": ["many", -5, 1.5, np.nan],
    "aborted": [5, np.bytes_(b"\xff")],
}  # fmt: skip


def _attribute(rng, file):
    name = str(rng.choice(list(_WRONG_ATTRIBUTES)))
    values = _WRONG_ATTRIBUTES[name]
    value = values[rng.integers(len(values))]
    file.attrs[name] = value
    return f"attribute {name} = {str(value)[:60]!r}"


def _no_text(rng, file):
    """Write invalid UTF-8 that is declared as UTF-8."""
    name = str(rng.choice(["experiment", "software", "rig", "source"]))
    kind = h5py.h5t.TypeID.copy(h5py.h5t.C_S1)
    kind.set_size(8)
    kind.set_cset(h5py.h5t.CSET_UTF8)
    file.attrs.create(name, np.bytes_(b"sweep\xff\xfe"), dtype=h5py.Datatype(kind).dtype)
    return f"attribute {name} is no UTF-8"


def _link(rng, file):
    name = _channel(rng, file)
    values = file[name][:]
    units = file[name].attrs["units"]
    del file[name]
    way = int(rng.integers(7))
    if way == 0:
        file[name] = h5py.ExternalLink("other.h5", f"/{name}")
    elif way == 1:
        file[name] = h5py.ExternalLink("/etc/passwd", "/x")
    elif way == 2:
        file[name] = h5py.SoftLink(f"/{name}")  # to itself
    elif way == 3:
        file[name] = h5py.SoftLink("/nothing")
    elif way == 4:
        file.create_group(name).attrs["units"] = units
    elif way == 5:
        source = h5py.VirtualSource("other.h5", name, shape=values.shape)
        layout = h5py.VirtualLayout(shape=values.shape, dtype=float)
        layout[:] = source
        file.create_virtual_dataset(name, layout).attrs["units"] = units
    else:
        outside = file.create_dataset(
            name, shape=values.shape, dtype=float, external=[("other.raw", 0, values.nbytes)]
        )
        outside.attrs["units"] = units
    return f"{name} is elsewhere, way {way}"


def _promise(rng, file):
    """Declare a size that the file does not have."""
    name = str(rng.choice(sorted(file)))
    units = file[name].attrs["units"]
    samples = int(rng.choice([10**7, 10**9, 10**12]))
    names = [name] if rng.random() < 0.7 else sorted(file)
    for each in names:
        del file[each]
        dataset = file.create_dataset(each, (samples,), "f8", chunks=(2**16,), compression="gzip")
        dataset.attrs["units"] = units
    return f"{', '.join(names)} declared with {samples:.0e} samples"


def _nested(rng, file):
    group = file
    for _ in range(int(rng.choice([10, 1000]))):
        group = group.create_group("g")
    group["back"] = h5py.SoftLink("/")
    file.move("theta_deg", f"{group.name}/theta_deg")
    return "theta_deg deep in groups"


def _long_json(rng, file):
    notes = json.dumps({f"c{k}_kpa": "x" for k in range(3000)})
    file.attrs["notes"] = notes[: int(rng.choice([100, 20000]))]
    return "notes cut short"


WRONG: tuple[Change, ...] = (
    _odd_sample, _odd_sample, _odd_channel, _drop_channel, _rename_channel, _units, _kind,
    _text_channel, _clock, _attribute_gone, _attribute, _attribute, _attribute, _attribute,
    _no_text, _link, _link, _promise, _nested, _long_json,
)  # fmt: skip
