"""Fitted models in HDF5 files."""

import json
import os
import sys
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_is_fitted

from fprc.errors import FprcError
from fprc.given import open_given
from fprc.models.sequence import SequenceModel


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
    plain = _describe(model, _known_classes(classes))
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
    open_given(path).close()
    try:
        with h5py.File(path, "r") as file:
            return _load(file, _known_classes(classes))
    except FprcError as error:
        raise FprcError(f"{path}: {error}") from error
    except (OSError, KeyError, TypeError, json.JSONDecodeError) as error:
        if number := getattr(error, "errno", None):
            raise FprcError(
                f"{path}: cannot be opened ({os.strerror(number)}); check the path"
            ) from error
        raise FprcError(f"{path}: holds no model of fprc ({error}); train it again") from error


def _known_classes(classes: Collection[type]) -> dict[str, type]:
    """Return the models of this package, ``classes`` and the other estimators of their modules."""
    # not imported by name, so that a rule does not depend on the code of every model
    modules = "fprc.models", *(each.__module__ for each in classes)
    members = [member for module in modules for member in vars(sys.modules[module]).values()]
    estimators = [
        each for each in members if isinstance(each, type) and issubclass(each, BaseEstimator)
    ]
    known = {each.__name__: each for each in (*estimators, *classes)}
    bases = BaseEstimator, SequenceModel
    return {name: each for name, each in known.items() if each not in bases}


def _class(name: str, known: Mapping[str, type]) -> type:
    if name in known:
        return known[name]
    raise FprcError(f"class {name} is unknown, so another version saved it; train the model again")


def _describe(model: BaseEstimator, known: Mapping[str, type]) -> dict[str, Any]:
    """Return everything that is written about a model."""
    name = _known_name(model, known)
    check_is_fitted(model)
    try:
        parameters = json.dumps(
            model.get_params(deep=False), default=lambda value: _plain(value, known)
        )
    except TypeError as error:
        raise FprcError(f"{name}: {error}; give random_state a number to save the model") from error
    learned = {
        key: _describe_learned(value, key, known)
        for key, value in sorted(vars(model).items())
        if key.endswith("_") and not key.startswith("_")
    }
    return {"class": name, "parameters": parameters, "learned": learned}


def _known_name(model: BaseEstimator, known: Mapping[str, type]) -> str:
    name = type(model).__name__
    if known.get(name) is not type(model):
        raise FprcError(f"{name} is not a model of fprc; save one of {', '.join(known)}")
    return name


def _describe_learned(value: Any, name: str, known: Mapping[str, type]) -> Any:
    """Return a part's description, or what HDF5 can hold: numbers, arrays of numbers, text."""
    if isinstance(value, BaseEstimator):
        return _describe(value, known)
    if isinstance(value, list) and value and isinstance(value[0], BaseEstimator):
        return {"list": [_describe(each, known) for each in value]}
    values = np.asarray(value)
    if values.dtype.kind in "biuf" or all(isinstance(each, str) for each in values.flat):
        return value
    raise FprcError(
        f"learned attribute {name} is {type(value).__name__}; only numbers, arrays of numbers and "
        "text can be saved"
    )


def _plain(value: object, known: Mapping[str, type]) -> Any:
    """Return a parameter in a form that JSON has; ``_parameter`` undoes this."""
    if isinstance(value, np.number | np.ndarray):
        return value.tolist()
    if isinstance(value, BaseEstimator):
        name = _known_name(value, known)
        return {"class": name, "parameters": value.get_params(deep=False)}
    raise TypeError(f"{type(value).__name__} is not a number")


def _parameter(plain: dict[str, Any], known: Mapping[str, type]) -> Any:
    """Return the unfitted estimator that ``_plain`` described."""
    if plain.keys() != {"class", "parameters"}:
        return plain
    return _class(plain["class"], known)(**plain["parameters"])


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


def _load(group: h5py.Group, known: Mapping[str, type]) -> Any:
    """Return a fitted estimator, or a list of them."""
    if "class" not in group.attrs and "0" in group:
        return [_load(group[str(i)], known) for i in range(len(group))]
    cls = _class(group.attrs["class"], known)
    parameters = group.attrs["parameters"]
    model = cls(**json.loads(parameters, object_hook=lambda plain: _parameter(plain, known)))
    for key in json.loads(group.attrs["learned"]):
        value = group[key]
        is_part = isinstance(value, h5py.Group)
        setattr(model, key, _load(value, known) if is_part else _read_value(value))
    if hasattr(model, "reset"):
        model.reset()
    return model


def _read_value(dataset: h5py.Dataset) -> Any:
    if h5py.check_string_dtype(dataset.dtype):
        return dataset.asstr()[()]
    learned = dataset[()]
    return learned.item() if isinstance(learned, np.generic) else learned
