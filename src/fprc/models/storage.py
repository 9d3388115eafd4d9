"""Fitted models in files: an HDF5 file of one text and some arrays, behind a checksum.

The first 512 bytes, HDF5's user block, hold the SHA-256 of all others, so a damaged file is refused
before the HDF5 library reads it. The text is JSON: the model as it is before ``fit``, and the words
that it learned. What else it learned are arrays, each named by its place in the model, such as
``readout_.W_out_``.

A model is read by making it again, see ``fprc.models.learned``; what does not fit into it is
refused. A model that would not be read again is not written.
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

#: Longest message about a file, which may quote a name of any length.
_LONGEST = 1000

#: Name of the text.
_TEXT = "model"
_FORMAT = b"fprc model 2\n"
_BLOCK = 512
_HDF5 = b"\x89HDF\r\n\x1a\n"


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
        The class of the model, or of an estimator among its parameters, is neither of this package
        nor in ``classes``; a parameter is neither numbers nor text; or a learned attribute
        cannot be saved: it is not finite, not as the class learns it, or neither numbers nor text.
    """
    check_is_fitted(model)
    parts, arrays, words = dict(_parts(model)), {}, {}
    try:
        for place, part in parts.items():
            for key, value in vars(part).items():
                if is_learned(key) and not _held(value):
                    numbers = np.asarray(value)
                    if numbers.dtype.kind in "biuf":
                        arrays[place + key] = numbers
                    else:
                        words[place + key] = numbers.tolist()
        text = json.dumps({"model": model, "words": words}, default=_plain, allow_nan=False)
        content = packed(text, dict(sorted(arrays.items())))
        for place, part in _parts(_restored(content, classes)):
            if _common(part) != _common(parts[place]):
                raise ValueError(f"{place}: its class and parameters are not those of make_...()")
    except (FprcError, TypeError, ValueError) as error:
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
        The file cannot be opened, is too large, was changed, or holds no model of this package:
        it names the file, and the part and attribute that is wrong.
    """
    content = read_given(path, most_bytes=MOST_BYTES)
    try:
        model = _restored(content, classes)
        if hasattr(model, "reset"):
            model.reset()
        return model
    except FprcError as error:
        raise FprcError(f"{path}: {str(error)[:_LONGEST]}") from error
    except Exception as error:  # on a file of somebody else, libraries and classes raise any type
        why = f"{type(error).__name__}: {error}"[:_LONGEST]
        raise FprcError(f"{path}: holds no model of fprc ({why}); train it again") from error


def packed(text: str, arrays: Mapping[str, np.ndarray]) -> bytes:
    """Return the content of a file.

    Raises
    ------
    FprcError
        It is too large.
    """
    # in memory: HDF5 on a full disk crashes the process at exit
    with h5py.File(_TEXT, "w", driver="core", backing_store=False) as file:
        file.create_dataset(_TEXT, data=np.bytes_(text.encode()))
        for name, values in arrays.items():
            file.create_dataset(name, data=values)
        file.flush()
        image = file.id.get_file_image()
    if _BLOCK + len(image) > MOST_BYTES:
        raise FprcError(
            f"takes {(_BLOCK + len(image)) / 1e6:.0f} MB, the limit is {MOST_BYTES / 1e6:.0f} MB, "
            "train a smaller one"
        )
    return sealed(image)


def sealed(image: bytes) -> bytes:
    """Return an HDF5 file behind the block with its checksum."""
    checksum = hashlib.sha256(image).hexdigest().encode()
    return (_FORMAT + checksum + b"\n").ljust(_BLOCK, b"\0") + image


def _unpacked(content: bytes) -> dict[str, Any]:
    """Return the text and every array of a file by name."""
    image = content[_BLOCK:]
    if content != sealed(image):
        if content.startswith(_HDF5) and b"time_s" in content:  # the name of a channel
            raise FprcError("is a log, no model; give the model of `fprc train` here")
        if not content.startswith(_FORMAT):
            raise FprcError("holds no model of fprc, or one of another version; train it again")
        raise FprcError(
            "was changed after it was saved: its SHA-256 is not the one that it holds; restore the "
            "file, or train the model again"
        )
    with h5py.File(h5py.h5f.open_file_image(image)) as file:
        if sum(file[name].nbytes for name in file) > len(image):
            raise FprcError("declares more numbers than it has bytes; train the model again")
        return {name: file[name][()] for name in file}


def _restored(content: bytes, classes: Collection[type]) -> Any:
    values, known = _unpacked(content), _known_classes(classes)

    def unfitted(described: dict[str, Any]) -> Any:
        return _unfitted(described, known) if described.keys() == _KEYS else described

    text = json.loads(values.pop(_TEXT), object_hook=unfitted)
    for name, array in values.items():
        if not np.isfinite(array).all():
            raise FprcError(f"{name}: holds NaN or infinity; train the model again")
    learned = {name: value if np.ndim(value) else value.item() for name, value in values.items()}
    for name, value in text["words"].items():
        learned[name] = np.array(value, dtype=object) if isinstance(value, list) else value
    try:
        model = restore(text["model"], learned)
    except ValueError as error:
        raise FprcError(f"{error}; train the model again") from error
    if learned:
        raise FprcError(f"{', '.join(learned)}: is no part of the model; train it again")
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


#: Keys of an estimator in the text.
_KEYS = {"class", "parameters"}


def _plain(value: Any) -> Any:
    """Return a value as JSON has it: an estimator as class and parameters, an array as a list."""
    if isinstance(value, BaseEstimator):
        return {"class": type(value).__name__, "parameters": value.get_params(deep=False)}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(
        f"a parameter is a {type(value).__name__}, which is neither numbers nor text; change it"
    )


def _unfitted(described: Mapping[str, Any], known: Mapping[str, type]) -> Any:
    """Return the estimator of ``_plain``."""
    name, parameters = described["class"], described["parameters"]
    if name not in known:
        raise FprcError(
            f"class {name} is unknown: a class of your own must be given, by --config or as one of "
            "classes; else another version saved it, so train the model again"
        )
    try:
        model = known[name](**parameters)
    except TypeError as error:
        raise FprcError(f"{name}: {error}, so another version saved it; train it again") from error
    missing = model.get_params(deep=False).keys() - parameters.keys()
    if is_built_in(model) and missing:
        keys = ", ".join(sorted(missing))
        raise FprcError(f"{name}: has no {keys}, so another version saved it; train it again")
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


def _common(part: BaseEstimator) -> tuple[type, str]:
    """Return class and parameters; a cross-validation gives the readout of a fold another seed."""
    parameters = part.get_params(deep=False)
    parameters.pop("random_state", None)
    return type(part), json.dumps(parameters, default=_plain)
