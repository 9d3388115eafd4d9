"""Fitted models in HDF5 files."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_is_fitted

from fprc.errors import FprcError
from fprc.models.esn import ESN
from fprc.models.features import EchoStates, TapFeatures
from fprc.models.fprc import FPRC, FuzzyLinear
from fprc.models.ridge import RidgeReadout
from fprc.models.takagi_sugeno import TakagiSugenoReadout

_CLASSES = (ESN, FPRC, FuzzyLinear, EchoStates, TapFeatures, RidgeReadout, TakagiSugenoReadout)
_KNOWN = {known.__name__: known for known in _CLASSES}


def save_model(model: BaseEstimator, path: Path | str) -> None:
    """Write a fitted model: class, parameters, and every learned attribute.

    Raises
    ------
    FprcError
        The class is not one of this package's, or ``random_state`` is neither
        a number nor None.
    """
    plain = _described(model)
    # in memory: HDF5 crashes the process at its end if it could not write all to a full disk
    with h5py.File("model", "w", driver="core", backing_store=False) as file:
        _save(plain, file)
        file.flush()
        image = file.id.get_file_image()
    Path(path).write_bytes(image)


def load_model(path: Path | str) -> BaseEstimator:
    """Read a model that ``save_model`` wrote.

    Raises
    ------
    FprcError
        The file cannot be read, or holds no model of this package.
    """
    try:
        with h5py.File(path, "r") as file:
            return _load(file, path)
    except (OSError, KeyError, TypeError, json.JSONDecodeError) as error:
        raise FprcError(f"{path}: holds no model of fprc ({error}); train it again") from error


def _described(model: BaseEstimator) -> dict[str, Any]:
    """Return all that is to be written, so that a refusal comes before the file."""
    name = type(model).__name__
    if name not in _KNOWN:
        raise FprcError(f"{name} is not a model of fprc; save one of {', '.join(_KNOWN)}")
    check_is_fitted(model)
    try:
        parameters = json.dumps(model.get_params(deep=False), default=_number)
    except TypeError as error:
        raise FprcError(f"{name}: {error}; give random_state a number to save the model") from error
    learned = {
        key: _described(value) if isinstance(value, BaseEstimator) else value
        for key, value in sorted(vars(model).items())
        if key.endswith("_") and not key.startswith("_")
    }
    return {"class": name, "parameters": parameters, "learned": learned}


def _number(value: object) -> int | float:
    if isinstance(value, np.number):
        return value.item()
    raise TypeError(f"{type(value).__name__} is not a number")


def _save(described: Mapping[str, Any], group: h5py.Group) -> None:
    group.attrs["class"] = described["class"]
    group.attrs["parameters"] = described["parameters"]
    group.attrs["learned"] = json.dumps(list(described["learned"]))
    for key, value in described["learned"].items():
        if isinstance(value, dict):
            _save(value, group.create_group(key))
        else:
            group.create_dataset(key, data=value)


def _load(group: h5py.Group, path: Path | str) -> BaseEstimator:
    name = group.attrs["class"]
    if name not in _KNOWN:
        raise FprcError(f"{path}: class {name} is unknown; it was saved by another version")
    model = _KNOWN[name](**json.loads(group.attrs["parameters"]))
    for key in json.loads(group.attrs["learned"]):
        value = group[key]
        setattr(model, key, _load(value, path) if isinstance(value, h5py.Group) else _plain(value))
    if hasattr(model, "reset"):
        model.reset()
    return model


def _plain(dataset: h5py.Dataset) -> Any:
    if h5py.check_string_dtype(dataset.dtype):
        return dataset.asstr()[()]
    learned = dataset[()]
    return learned.item() if isinstance(learned, np.generic) else learned
