"""Fitted models in files: an HDF5 file of one text and some arrays, behind a checksum.

The first 512 bytes, HDF5's user block, hold the SHA-256 of all others, so a damaged file is refused
before the HDF5 library reads it. The text is JSON: class, parameters and learned attributes of the
model and of its parts. Arrays are named by their place in the model, such as ``readout_.W_out_``.

A file may come from anybody, and may move a rig. All numbers must lie in the file as they are: a
link or a chunk could lead to another file, or to more than there is. What was learned must be as
``fprc.models.limits`` says, the parts those that the parameters make, and the model make a step.
"""

import hashlib
import json
import re
import sys
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_is_fitted

from fprc.errors import FprcError
from fprc.given import read_given
from fprc.models.compose import SideBySide
from fprc.models.limits import check_learned, is_built_in
from fprc.models.sequence import SequenceModel

#: Largest file, bytes: an ESN of 4,000 nodes takes 128 MB. Longest text, bytes.
MOST_BYTES, _LONGEST_TEXT = 150_000_000, 1_000_000

_TEXT, _BLOCK, _FORMAT = "model", 512, b"fprc model 2\n"


def save_model(model: SequenceModel, path: Path | str, classes: Collection[type] = ()) -> None:
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
        ``classes``, or what it learned is neither finite numbers nor text.
    """
    check_is_fitted(model)
    arrays = dict[str, np.ndarray]()
    try:
        text = json.dumps(_kept(model, "", arrays), default=_plain, allow_nan=False)
        content = packed(text, arrays)
        _restored(content, classes)
    except Exception as error:  # of a class from outside, any
        raise FprcError(f"{type(model).__name__}: cannot be saved: {error}") from error
    Path(path).write_bytes(content)


def load_model(path: Path | str, classes: Collection[type] = ()) -> SequenceModel:
    """Read a model that ``save_model``, with the same ``classes``, wrote.

    Raises
    ------
    FprcError
        The file cannot be opened, is too large, was changed, or holds no model of this package.
    """
    content = read_given(path, most_bytes=MOST_BYTES)
    try:
        return _restored(content, classes)
    except Exception as error:  # on a file of somebody else, libraries and classes raise any type
        why = str(error) if type(error) is ValueError else f"{type(error).__name__}: {error}"
        raise FprcError(
            f"{path}: holds no model that this version of fprc can use: {why:.1000}; "
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


def _restored(content: bytes, classes: Collection[type]) -> SequenceModel:
    if not content.startswith(_FORMAT):
        raise ValueError("it is none, or one of another version")
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
        size = sum(data.nbytes for data in file.values())
        if size > len(content) or file[_TEXT].nbytes > _LONGEST_TEXT:
            raise ValueError("it declares more numbers than it has bytes, or too long a text")
        values = {name: data[()] for name, data in file.items()}
    text = values.pop(_TEXT)
    for name, array in values.items():
        if not np.isfinite(array).all():
            raise ValueError(f"{name}: holds NaN or infinity")
    # not imported by name, so that a rule does not depend on the code of every model
    known: dict[str, Any] = dict(vars(sys.modules["fprc.models"]))
    for cls in classes:
        known |= vars(sys.modules[cls.__module__])
    known |= {cls.__name__: cls for cls in classes}
    model = json.loads(text, object_hook=lambda found: _made(found, values, known))
    if not isinstance(model, SequenceModel):
        raise ValueError(f"{type(model).__name__} is no model, but a part of one or something else")
    model.step(np.zeros(model.n_features_in_))  # parts that do not belong together raise any error
    model.reset()
    return model


def _is_learned(key: str) -> bool:
    return key.isidentifier() and key.endswith("_") and not key.startswith("_")


def _kept(value: Any, place: str, arrays: dict[str, np.ndarray]) -> Any:
    """Return what was learned as JSON has it; add its arrays, named by their place."""
    if isinstance(value, BaseEstimator):
        learned = {
            key: _kept(found, f"{place}.{key}".lstrip("."), arrays)
            for key, found in vars(value).items()
            if _is_learned(key)
        }
        return _plain(value) | {"learned": learned}
    if isinstance(value, list):
        return [_kept(item, f"{place}.{i}", arrays) for i, item in enumerate(value)]
    if not isinstance(value, np.ndarray):
        return value
    if value.dtype.kind not in "biuf":
        return {"words": value.tolist()}
    arrays[place] = value
    return {"array": place}


def _plain(value: Any) -> Any:
    """Return an unfitted estimator as class and parameters, an array of parameters as a list."""
    if isinstance(value, BaseEstimator):
        parameters = value.get_params(deep=False)
        return {"class": type(value).__name__, "parameters": parameters, "learned": {}}
    return value.tolist()


def _made(found: dict[str, Any], arrays: dict[str, Any], known: Mapping[str, Any]) -> Any:
    """Return what a part of the text describes: an estimator, an array, or itself."""
    if found.keys() == {"array"}:
        return arrays[found["array"]]
    if found.keys() == {"words"}:
        return np.array([str(word) for word in found["words"]], dtype=object)
    if found.keys() != {"class", "parameters", "learned"}:
        return found
    name, parameters, learned = found["class"], found["parameters"], found["learned"]
    cls = known.get(name)
    if not isinstance(cls, type) or not issubclass(cls, BaseEstimator):
        raise ValueError(
            f"class {name!r:.60} is unknown; give a class of your own by --config or in classes"
        )
    model = cls(**parameters)
    if missing := model.get_params(deep=False).keys() - parameters.keys():
        raise ValueError(f"{name}: {', '.join(sorted(missing))} is missing")
    for key, value in learned.items():
        if not _is_learned(key):
            raise ValueError(f"{key!r:.60} is no name of something learned")
        setattr(model, key, value)
    if not learned:
        return model
    if is_built_in(model):
        check_learned(model, learned.keys())
    fitted, made = list[Any](), list[Any]()
    if isinstance(model, SequenceModel):
        fitted = [model.features_, model.readout_]
        made = [model.make_features(), model.make_readout()]
    elif isinstance(model, SideBySide):
        fitted, made = model.maps_, [part for part, _ in model.maps]
    if _unseeded(fitted) != _unseeded(made):
        raise ValueError(f"{name}: its parts are not those that its parameters make")
    return model


def _unseeded(parts: list[BaseEstimator]) -> str:
    """Return classes and parameters as text, but for the seeds: a fold of the data has its own."""
    return re.sub(r'"random_state": (null|\d+)', "", json.dumps(parts, default=_plain))
