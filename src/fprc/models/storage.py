"""Fitted models in HDF5 files."""

import json
from pathlib import Path

import h5py
import numpy as np
from sklearn.base import BaseEstimator

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
    with h5py.File(path, "w") as file:
        _save(model, file)


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
    except (OSError, KeyError, json.JSONDecodeError) as error:
        raise FprcError(f"{path}: holds no model of fprc ({error}); train it again") from error


def _save(model: BaseEstimator, group: h5py.Group) -> None:
    name = type(model).__name__
    if name not in _KNOWN:
        raise FprcError(f"{name} is not a model of fprc; save one of {', '.join(_KNOWN)}")
    try:
        parameters = json.dumps(model.get_params(deep=False))
    except TypeError as error:
        raise FprcError(f"{name}: {error}; give random_state a number to save the model") from error
    group.attrs.update({"class": name, "parameters": parameters})
    for key, value in sorted(vars(model).items()):
        if key.startswith("_") or not key.endswith("_"):
            continue
        if isinstance(value, BaseEstimator):
            _save(value, group.create_group(key))
        else:
            group.create_dataset(key, data=value)


def _load(group: h5py.Group, path: Path | str) -> BaseEstimator:
    name = group.attrs["class"]
    if name not in _KNOWN:
        raise FprcError(f"{path}: class {name} is unknown; it was saved by another version")
    model = _KNOWN[name](**json.loads(group.attrs["parameters"]))
    for key, value in group.items():
        if isinstance(value, h5py.Group):
            setattr(model, key, _load(value, path))
        else:
            learned = value[()]
            setattr(model, key, learned.item() if isinstance(learned, np.generic) else learned)
    if hasattr(model, "reset"):
        model.reset()
    return model
