"""Fitted models in files."""

import json
import sys
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_is_fitted

from fprc.errors import FprcError
from fprc.given import read_given
from fprc.models.learned import check_learned, describe, is_built_in, is_learned
from fprc.models.model_file import MOST_BYTES, model_file, read_model_file
from fprc.models.sequence import SequenceModel

Arrays = dict[str, np.ndarray]

#: Longest message about a file, which may quote a name of any length.
_LONGEST = 1000


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
        ``classes``; ``random_state`` is neither a number nor None; or a learned attribute cannot
        be saved: it is not finite, not as the class learns it, or neither numbers nor text.
    """
    names = {cls: name for name, cls in _known_classes(classes).items()}
    arrays: Arrays = {}

    def plain(value: object) -> str:
        if isinstance(value, type):
            return _name_of(value, names)
        raise TypeError(f"{type(value).__name__} is not a number")

    described = _describe(model, names, arrays, "")
    try:
        text = json.dumps(described, default=plain, allow_nan=False)
    except TypeError as error:
        raise FprcError(
            f"{type(model).__name__}: {error}; give random_state a number to save the model"
        ) from error
    except ValueError as error:
        raise FprcError(
            f"{type(model).__name__}: {error}; only finite numbers can be saved"
        ) from error
    _check(model)
    Path(path).write_bytes(model_file(text, arrays))


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
    known = _known_classes(classes)
    content = read_given(path, most_bytes=MOST_BYTES)
    try:
        described, arrays = read_model_file(content)
        model = _restore(described, arrays, known, "")
        if arrays:
            raise FprcError(f"{', '.join(arrays)}: is no part of the model; train it again")
        _check(model)
        if hasattr(model, "reset"):
            model.reset()
        return model
    except FprcError as error:
        raise FprcError(f"{path}: {str(error)[:_LONGEST]}") from error
    except Exception as error:  # on a file of somebody else, libraries and classes raise any type
        why = f"{type(error).__name__}: {error}"[:_LONGEST]
        raise FprcError(f"{path}: holds no model of fprc ({why}); train it again") from error


def _known_classes(classes: Collection[type]) -> dict[str, type]:
    """Return the models of this package, ``classes`` and the other estimators of their modules."""
    # not imported by name, so that a rule does not depend on the code of every model
    modules = "fprc.models", *(known_class.__module__ for known_class in classes)
    members = [member for module in modules for member in vars(sys.modules[module]).values()]
    estimators = [
        member
        for member in members
        if isinstance(member, type) and issubclass(member, BaseEstimator)
    ]
    known = {known_class.__name__: known_class for known_class in (*estimators, *classes)}
    bases = BaseEstimator, SequenceModel
    return {name: known_class for name, known_class in known.items() if known_class not in bases}


def _name_of(cls: type, names: Mapping[type, str]) -> str:
    if cls not in names:
        known = ", ".join(names.values())
        raise FprcError(
            f"{cls.__name__} is not a model of fprc, which are {known}; give its class "
            f"too: save_model(model, path, [{cls.__name__}])"
        )
    return names[cls]


def _describe(
    model: BaseEstimator, names: Mapping[type, str], arrays: Arrays, place: str
) -> dict[str, Any]:
    """Return class, parameters and learned attributes; add arrays by their place in the model."""
    _name_of(type(model), names)
    check_is_fitted(model)
    learned = {
        key: _describe_learned(value, names, arrays, f"{place}{key}")
        for key, value in sorted(vars(model).items())
        if is_learned(key)
    }
    return {**describe(model), "learned": learned}


def _describe_learned(value: Any, names: Mapping[type, str], arrays: Arrays, place: str) -> Any:
    if isinstance(value, BaseEstimator):
        return _describe(value, names, arrays, f"{place}.")
    if isinstance(value, list) and value and isinstance(value[0], BaseEstimator):
        parts = enumerate(value)
        return [_describe(part, names, arrays, f"{place}.{i}.") for i, part in parts]
    values = np.asarray(value)
    if values.dtype.kind not in "biuf":
        if all(isinstance(element, str) for element in values.flat):
            return values.tolist()
        raise FprcError(
            f"learned attribute {place} is {type(value).__name__}; only numbers, arrays of numbers "
            "and text can be saved"
        )
    if values.ndim:
        arrays[place] = values
        return {"array": place}
    return values.item()


def _check(model: BaseEstimator) -> None:
    try:
        check_learned(model)
    except ValueError as error:
        raise FprcError(f"{error}; train the model again") from error


def _restore(described: Any, arrays: Arrays, known: Mapping[str, type], place: str) -> Any:
    """Return a fitted estimator; take its arrays out of ``arrays``."""
    if not isinstance(described, dict) or described.keys() != {"class", "parameters", "learned"}:
        raise FprcError(
            f"{place.rstrip('.') or 'model'}: must be class, parameters and learned; train it again"
        )
    model = _unfitted(described, known)
    for key, value in described["learned"].items():
        if not is_learned(key):
            raise FprcError(f"{place}{key}: is no name of a learned attribute; train it again")
        setattr(model, key, _restore_learned(value, arrays, known, f"{place}{key}"))
    return model


def _restore_learned(value: Any, arrays: Arrays, known: Mapping[str, type], place: str) -> Any:
    if isinstance(value, dict) and value.keys() == {"array"}:
        if value["array"] != place or place not in arrays:
            raise FprcError(f"{place}: is not in the file; train the model again")
        return arrays.pop(place)
    if isinstance(value, dict):
        return _restore(value, arrays, known, f"{place}.")
    if isinstance(value, list) and value and isinstance(value[0], dict):
        parts = enumerate(value)
        return [_restore(part, arrays, known, f"{place}.{i}.") for i, part in parts]
    return np.array(value, dtype=object) if isinstance(value, list) else value


def _unfitted(described: Mapping[str, Any], known: Mapping[str, type]) -> Any:
    """Return the estimator of ``describe``."""
    name, parameters = described["class"], described["parameters"]
    if not isinstance(name, str) or name not in known:
        raise FprcError(
            f"class {name} is unknown: a class of your own must be given, by --config or as one of "
            "classes; else another version saved it, so train the model again"
        )
    given = {key: _parameter(value, known) for key, value in parameters.items()}
    try:
        model = known[name](**given)
    except TypeError as error:
        raise FprcError(f"{name}: {error}, so another version saved it; train it again") from error
    if is_built_in(model) and (missing := model.get_params(deep=False).keys() - given.keys()):
        keys = ", ".join(sorted(missing))
        raise FprcError(f"{name}: has no {keys}, so another version saved it; train it again")
    return model


def _parameter(value: Any, known: Mapping[str, type]) -> Any:
    if isinstance(value, list):
        return [_parameter(element, known) for element in value]
    if isinstance(value, dict) and value.keys() == {"class", "parameters"}:
        return _unfitted(value, known)
    return value
