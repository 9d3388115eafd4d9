"""Fitted models in HDF5 files."""

import json
import os
import sys
from collections.abc import Collection, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_is_fitted

from fprc.errors import FprcError

#: Modules of the classes that can be saved; only the classes of the loaded model are imported.
_MODULES = {
    "ESN": "fprc.models.esn",
    "NVAR": "fprc.models.nvar",
    "FeatureModel": "fprc.models.feature_model",
    "LowpassBank": "fprc.models.lowpass_bank",
    "PlayOperators": "fprc.models.plays",
    "SideBySide": "fprc.models.side_by_side",
    "EchoStates": "fprc.models.echo_features",
    "FPRC": "fprc.models.fprc",
    "FuzzyLinear": "fprc.models.fprc",
    "TapFeatures": "fprc.models.features",
    "RidgeReadout": "fprc.models.ridge_readout",
    "TakagiSugenoReadout": "fprc.models.takagi_sugeno",
}


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
        The class of the model, or of a part of it, is neither of this package nor in
        ``classes``; ``random_state`` is neither a number nor None; or HDF5 cannot hold a learned
        attribute.
    """
    plain = _describe(model, _outside_classes(classes))
    # in memory: HDF5 on a full disk crashes the process at exit
    with h5py.File("model", "w", driver="core", backing_store=False) as file:
        _save(plain, file)
        file.flush()
        image = file.id.get_file_image()
    Path(path).write_bytes(image)


def load_model(path: Path | str, classes: Collection[type] = ()) -> BaseEstimator:
    """Read a model that ``save_model`` wrote.

    Parameters
    ----------
    classes : collection of type
        As ``save_model`` takes them.

    Raises
    ------
    FprcError
        The file cannot be read, or holds no model of this package.
    """
    try:
        with h5py.File(path, "r") as file:
            return _load(file, _outside_classes(classes))
    except FprcError as error:
        raise FprcError(f"{path}: {error}") from error
    except (OSError, KeyError, TypeError, json.JSONDecodeError) as error:
        if number := getattr(error, "errno", None):
            raise FprcError(
                f"{path}: cannot be opened ({os.strerror(number)}); check the path"
            ) from error
        raise FprcError(f"{path}: holds no model of fprc ({error}); train it again") from error


def _outside_classes(classes: Collection[type]) -> dict[str, type]:
    """Return ``classes`` and every other estimator of their modules, by name."""
    neighbours = [
        member
        for each in classes
        for member in vars(sys.modules[each.__module__]).values()
        if isinstance(member, type) and issubclass(member, BaseEstimator)
    ]
    return {known.__name__: known for known in (*classes, *neighbours)}


def _class_named(name: str, outside: Mapping[str, type]) -> type | None:
    if name in outside:
        return outside[name]
    return getattr(import_module(_MODULES[name]), name) if name in _MODULES else None


def _class(name: str, outside: Mapping[str, type]) -> type:
    if known := _class_named(name, outside):
        return known
    raise FprcError(f"class {name} is unknown, so another version saved it; train the model again")


def _describe(model: BaseEstimator, outside: Mapping[str, type]) -> dict[str, Any]:
    """Return everything that is written about a model."""
    name = _known_name(model, outside)
    check_is_fitted(model)
    try:
        parameters = json.dumps(
            model.get_params(deep=False), default=lambda value: _plain(value, outside)
        )
    except TypeError as error:
        raise FprcError(f"{name}: {error}; give random_state a number to save the model") from error
    learned = {
        key: _describe_learned(value, key, outside)
        for key, value in sorted(vars(model).items())
        if key.endswith("_") and not key.startswith("_")
    }
    return {"class": name, "parameters": parameters, "learned": learned}


def _known_name(model: BaseEstimator, outside: Mapping[str, type]) -> str:
    name = type(model).__name__
    known: Any = _class_named(name, outside)
    if known is not type(model):
        raise FprcError(f"{name} is not a model of fprc; save one of {', '.join(_MODULES)}")
    return name


def _describe_learned(value: Any, name: str, outside: Mapping[str, type]) -> Any:
    if isinstance(value, BaseEstimator):
        return _describe(value, outside)
    if isinstance(value, list) and value and isinstance(value[0], BaseEstimator):
        return {"list": [_describe(each, outside) for each in value]}
    return _checked(value, name)


def _checked(value: Any, name: str) -> Any:
    """Return a learned attribute that HDF5 can hold: numbers, arrays of numbers, text."""
    values = np.asarray(value)
    if values.dtype.kind in "biuf" or all(isinstance(each, str) for each in values.flat):
        return value
    raise FprcError(
        f"learned attribute {name} is {type(value).__name__}; only numbers, arrays of numbers and "
        "text can be saved"
    )


def _plain(value: object, outside: Mapping[str, type]) -> Any:
    """Return a parameter in a form that JSON has; ``_parameter`` undoes this."""
    if isinstance(value, np.number | np.ndarray):
        return value.tolist()
    if isinstance(value, BaseEstimator):
        name = _known_name(value, outside)
        return {"class": name, "parameters": value.get_params(deep=False)}
    raise TypeError(f"{type(value).__name__} is not a number")


def _parameter(plain: dict[str, Any], outside: Mapping[str, type]) -> Any:
    """Return the unfitted estimator that ``_plain`` described."""
    if plain.keys() != {"class", "parameters"}:
        return plain
    return _class(plain["class"], outside)(**plain["parameters"])


def _save(described: Mapping[str, Any], group: h5py.Group) -> None:
    if "list" in described:
        for i, each in enumerate(described["list"]):
            _save(each, group.create_group(str(i)))
        return
    group.attrs["class"] = described["class"]
    group.attrs["parameters"] = described["parameters"]
    group.attrs["learned"] = json.dumps(list(described["learned"]))
    for key, value in described["learned"].items():
        if isinstance(value, dict):
            _save(value, group.create_group(key))
        else:
            group.create_dataset(key, data=value)


def _load(group: h5py.Group, outside: Mapping[str, type]) -> Any:
    """Return a fitted estimator, or a list of them."""
    if "class" not in group.attrs and "0" in group:
        return [_load(group[str(i)], outside) for i in range(len(group))]
    cls = _class(group.attrs["class"], outside)
    parameters = group.attrs["parameters"]
    model = cls(**json.loads(parameters, object_hook=lambda plain: _parameter(plain, outside)))
    for key in json.loads(group.attrs["learned"]):
        value = group[key]
        is_part = isinstance(value, h5py.Group)
        setattr(model, key, _load(value, outside) if is_part else _read_value(value))
    if hasattr(model, "reset"):
        model.reset()
    return model


def _read_value(dataset: h5py.Dataset) -> Any:
    if h5py.check_string_dtype(dataset.dtype):
        return dataset.asstr()[()]
    learned = dataset[()]
    return learned.item() if isinstance(learned, np.generic) else learned
