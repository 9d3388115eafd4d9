"""Fitted models in files: an HDF5 file of one text and some arrays, behind a checksum.

The first 512 bytes, HDF5's user block, hold the SHA-256 of all others, so a damaged file is refused
before the HDF5 library reads it. The text is JSON: the model as it is before ``fit``, and the words
that it learned. What else it learned are arrays, each named by its place in the model, such as
``readout_.W_out_``.

A file may come from anybody, and may move a rig. All numbers must lie in the file as they are: a
link or a chunk could lead to another file, or to more than there is. The model is made again from
its parameters, and takes what fits, see ``fprc.models.learned``; anything else is refused.
"""

import hashlib
import json
import sys
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_is_fitted

from fprc.errors import FprcError
from fprc.given import read_given
from fprc.models.learned import is_built_in, is_learned, restore

#: Largest file, bytes: an ESN of 4,000 nodes takes 128 MB.
MOST_BYTES = 150_000_000
#: Longest text, bytes, and longest message about a file, which may quote a name of any length.
_LONGEST_TEXT, _LONGEST_MESSAGE = 1_000_000, 1000

_TEXT, _BLOCK, _FORMAT = "model", 512, b"fprc model 2\n"


def save_model(model: BaseEstimator, path: Path | str, classes: Collection[type] = ()) -> None:
    """Write a fitted model: class, parameters, and every learned attribute.

    Parameters
    ----------
    classes : collection of type
        Models from outside this package that may be saved too, with every other estimator of
        their modules.

    Raises
    ------
    FprcError
        The model would not be read again: the class of a part is neither of this package nor in
        ``classes``, or what it holds is neither finite numbers nor text, as its class learns them.
    """
    check_is_fitted(model)
    parts = dict(_parts(model))
    arrays, words = dict[str, np.ndarray](), dict[str, np.ndarray]()
    try:
        for place, part in parts.items():
            for key, value in vars(part).items():
                if is_learned(key) and not _held(value):
                    numbers = np.asarray(value)
                    (arrays if numbers.dtype.kind in "biuf" else words)[place + key] = numbers
        text = json.dumps({"model": model, "words": words}, default=_plain, allow_nan=False)
        content = packed(text, arrays)
        for place, part in _parts(_restored(content, classes)):
            if _described(part) != _described(parts[place]):
                raise ValueError(f"{place}: its class and parameters are not those of make_...()")
    except (TypeError, ValueError) as error:
        raise FprcError(f"{type(model).__name__}: cannot be saved: {error}") from error
    Path(path).write_bytes(content)


def load_model(path: Path | str, classes: Collection[type] = ()) -> BaseEstimator:
    """Read a model that ``save_model`` wrote.

    Parameters
    ----------
    classes : collection of type
        As ``save_model`` takes them.

    Raises
    ------
    FprcError
        The file cannot be opened, is too large, was changed, or holds no model of this package.
    """
    content = read_given(path, most_bytes=MOST_BYTES)
    try:
        model = _restored(content, classes)
        if hasattr(model, "reset"):
            model.reset()
        return model
    except Exception as error:  # on a file of somebody else, libraries and classes raise any type
        why = str(error) if type(error) is ValueError else f"{type(error).__name__}: {error}"
        raise FprcError(
            f"{path}: holds no model that this version of fprc can use: {why[:_LONGEST_MESSAGE]}; "
            "give a model of `fprc train` or of the workflow, or train it again"
        ) from error


def packed(text: str, arrays: Mapping[str, np.ndarray]) -> bytes:
    """Return the content of a file, unless it is too large."""
    # in memory: HDF5 on a full disk crashes the process at exit
    with h5py.File(_TEXT, "w", driver="core", backing_store=False) as file:
        file.create_dataset(_TEXT, data=np.bytes_(text.encode()))
        for name, values in sorted(arrays.items()):
            file.create_dataset(name, data=values)
        file.flush()
        content = sealed(file.id.get_file_image())
    if len(content) > MOST_BYTES:
        raise ValueError(f"takes {len(content):,} bytes; at most {MOST_BYTES:,} are possible")
    return content


def sealed(image: bytes) -> bytes:
    """Return an HDF5 file behind the block with its checksum."""
    checksum = hashlib.sha256(image).hexdigest().encode()
    return (_FORMAT + checksum + b"\n").ljust(_BLOCK, b"\0") + image


def _unpacked(content: bytes) -> dict[str, Any]:
    """Return the text and every array of a file by name."""
    if not content.startswith(_FORMAT):
        log = content.startswith(b"\x89HDF") and b"time_s" in content  # the name of a channel
        raise ValueError(f"it is {'a log' if log else 'none, or one of another version'}")
    if content != sealed(content[_BLOCK:]):
        raise ValueError("it was changed after it was saved, its SHA-256 is another")
    with h5py.File(h5py.h5f.open_file_image(content[_BLOCK:])) as file:
        if any(type(file.get(name, getlink=True)) is not h5py.HardLink for name in file):
            raise ValueError("it holds a link")
        for name, data in file.items():
            plan = data.id.get_create_plist()
            whole = plan.get_layout() in (h5py.h5d.CONTIGUOUS, h5py.h5d.COMPACT)
            if not whole or plan.get_external_count() or data.dtype.kind not in "biufS":
                raise ValueError(f"{name}: its numbers do not lie in the file as they are")
        sizes = {name: data.nbytes for name, data in file.items()}
        if sum(sizes.values()) > len(content) or sizes[_TEXT] > _LONGEST_TEXT:
            raise ValueError("it declares more numbers than it has bytes, or too long a text")
        return {name: data[()] for name, data in file.items()}


def _restored(content: bytes, classes: Collection[type]) -> Any:
    values, known = _unpacked(content), _known_classes(classes)
    text = json.loads(values.pop(_TEXT), object_hook=lambda found: _unfitted(found, known))
    for name, array in values.items():
        if not np.isfinite(array).all():
            raise ValueError(f"{name}: holds NaN or infinity")
    learned = {name: value if np.ndim(value) else value.item() for name, value in values.items()}
    for name, value in text["words"].items():
        learned[name] = np.array(value, dtype=object) if isinstance(value, list) else value
    model = restore(text["model"], learned)
    if learned:
        raise ValueError(f"{', '.join(learned)}: is no part of the model")
    return model


def _known_classes(classes: Collection[type]) -> dict[str, type]:
    """Return the models of this package, ``classes`` and the other estimators of their modules."""
    # not imported by name, so that a rule does not depend on the code of every model
    modules = "fprc.models", *(known_class.__module__ for known_class in classes)
    members = [member for module in modules for member in vars(sys.modules[module]).values()]
    return {
        member.__name__: member
        for member in (*members, *classes)
        if isinstance(member, type) and issubclass(member, BaseEstimator)
    }


def _plain(value: Any) -> Any:
    """Return a value as JSON has it: an estimator as class and parameters, an array as a list."""
    if isinstance(value, BaseEstimator):
        return {"class": type(value).__name__, "parameters": value.get_params(deep=False)}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"a parameter is a {type(value).__name__}, neither numbers nor text; change it")


def _unfitted(described: Mapping[str, Any], known: Mapping[str, type]) -> Any:
    """Return the estimator of ``_plain``; anything else as it is."""
    if described.keys() != {"class", "parameters"}:
        return described
    name, parameters = described["class"], described["parameters"]
    if name not in known:
        raise ValueError(
            f"class {name} is unknown; a class of your own must be given, by --config or in classes"
        )
    model = known[name](**parameters)
    missing = model.get_params(deep=False).keys() - parameters.keys()
    if is_built_in(model) and missing:
        raise ValueError(f"{name}: has no {', '.join(sorted(missing))}")
    return model


def _held(value: Any) -> dict[str, BaseEstimator]:
    """Return the fitted parts in a learned attribute, by what is added to its name."""
    listed = {f".{i}": part for i, part in enumerate(value)} if isinstance(value, list) else {}
    return {
        key: part for key, part in {"": value, **listed}.items() if isinstance(part, BaseEstimator)
    }


def _parts(model: BaseEstimator, place: str = "") -> Iterator[tuple[str, BaseEstimator]]:
    """Yield a model and all of its fitted parts, each with its place, such as ``readout_.``."""
    yield place, model
    for key, value in vars(model).items():
        if is_learned(key):
            for more, part in _held(value).items():
                yield from _parts(part, f"{place}{key}{more}.")


def _described(part: BaseEstimator) -> str:
    """Return class and parameters; a cross-validation gives the readout of a fold another seed."""
    parameters = part.get_params(deep=False) | {"random_state": None}
    return json.dumps([type(part).__name__, parameters], default=_plain)
