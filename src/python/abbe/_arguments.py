"""Checks of arguments, made before they are used."""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Mapping
from typing import Any, Union

from ._errors import OptionsError

Path = Union[str, bytes, "os.PathLike[str]"]


def path(name: str, value: Any, wanted: str = "the path of a file or folder") -> str:
    """Returns `value` as a path, or raises `TypeError`. `wanted` describes the argument in the error."""
    try:
        return os.fsdecode(value)
    except TypeError:
        raise TypeError(f"{name} is {wanted}, not {_shown(value)}") from None


def text(name: str, value: Any) -> str:
    """Returns `value` if it is a string, or raises `TypeError`."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is a string, not {_shown(value)}")
    return value


def whole(name: str, value: Any) -> int:
    """Returns `value` as an integer, or raises `TypeError`. Rejects True and False, which are integers in Python."""
    try:
        if not _is_truth(value):
            return operator.index(value)
    except TypeError:
        pass
    raise TypeError(f"{name} is a whole number, not {_shown(value)}")


def number(name: str, value: Any) -> float:
    """Returns `value` as a number, or raises `OptionsError`. Rejects booleans and strings."""
    try:
        if not _is_truth(value) and not isinstance(value, (str, bytes)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise OptionsError(f"{name} is a number, not {_shown(value)}", f"such as {name}=1")


def _is_truth(value: Any) -> bool:
    return type(value).__name__ in ("bool", "bool_")


def truth(name: str, value: Any) -> bool:
    """Returns `value` as a bool if it is a boolean of Python or numpy, or raises `OptionsError`."""
    if not _is_truth(value):
        raise OptionsError(f"{name} is True or False, not {_shown(value)}", "help(abbe.render) lists all arguments")
    return bool(value)


def function(name: str, value: Any) -> Callable[..., object]:
    """Returns `value` if it is callable, or raises `OptionsError`."""
    if not callable(value):
        raise OptionsError(f"{name} is a function, not {_shown(value)}", f"such as {name}=print")
    return value


def settings(value: Any) -> dict[str, Any]:
    """Returns the argument `set` as a dict, or raises `OptionsError` if it is no mapping or a key is no string."""
    if not isinstance(value, Mapping):
        raise OptionsError(f"set is a dict, not {_shown(value)}", 'such as set={"film.width": 320}')
    for key in value:
        if not isinstance(key, str):
            raise OptionsError(f"a key of set is a string, not {_shown(key)}", 'such as set={"film.width": 320}')
    return dict(value)


def _shown(value: object) -> str:
    shown = repr(value)
    return shown if len(shown) <= 40 else f"a value of the type {type(value).__name__}"
