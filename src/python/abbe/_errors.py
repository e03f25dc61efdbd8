"""Exceptions."""

from __future__ import annotations

from typing import NamedTuple


class Mistake(NamedTuple):
    """A mistake in a scene, as listed in `SceneError.mistakes`."""

    key: str | None
    """The path of the key in a dict, such as `object[2].shape.sphere.radios`, or the key in `set`. Entries of lists
    count from 0. None for a mistake in a scene file."""
    message: str
    """What is wrong."""
    help: str | None
    """How to fix it, if known."""
    file: str
    """The path of the scene file. Like `line` and `column`, it is only meaningful for a mistake in a file."""
    line: int
    """The line in the file, counted from 1."""
    column: int
    """The column in the file in characters, counted from 1."""


class RenderError(Exception):
    """Raised if a render fails, or a file cannot be decoded or encoded. The base class of the other errors."""

    message: str
    """What went wrong."""
    help: str | None
    """How to fix it, if known."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message, help)
        self.message, self.help = message, help

    def __str__(self) -> str:
        return f"{self.message} ({self.help})" if self.help else self.message


class OptionsError(RenderError, ValueError):
    """Raised if an argument has a value that is not allowed."""


class SceneError(RenderError, ValueError):
    """Raised if a scene contains mistakes. Its message includes all of them."""

    mistakes: list[Mistake]
    """All mistakes found in the scene, in the order of its text."""

    def __init__(self, message: str, mistakes: list[Mistake]) -> None:
        super().__init__(message)
        self.mistakes = [Mistake(*mistake) for mistake in mistakes]

    def __reduce__(self) -> tuple[type[SceneError], tuple[str, list[Mistake]]]:
        return type(self), (self.message, self.mistakes)
