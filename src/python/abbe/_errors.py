"""What can go wrong."""

from __future__ import annotations

from typing import NamedTuple


class Mistake(NamedTuple):
    """A mistake in a scene."""

    key: str | None
    """The path of the key in a dict, such as `object[2].shape.sphere.radios`: entries count from 0. None of a file."""
    message: str
    """What is wrong."""
    help: str | None
    """What to do."""
    file: str
    """The scene file, of a scene given as one."""
    line: int
    """The line in the file, from 1."""
    column: int
    """The column in the file, from 1."""


class RenderError(Exception):
    """A render, or a file, that failed."""

    message: str
    """What went wrong."""
    help: str | None
    """What to do."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message, help)
        self.message, self.help = message, help

    def __str__(self) -> str:
        return f"{self.message} ({self.help})" if self.help else self.message


class OptionsError(RenderError, ValueError):
    """An argument that asks for something impossible."""


class SceneError(RenderError, ValueError):
    """A scene that cannot be rendered because of its mistakes."""

    mistakes: list[Mistake]
    """All its mistakes, in the order of the scene."""

    def __init__(self, message: str, mistakes: list[Mistake]) -> None:
        super().__init__(message)
        self.mistakes = [Mistake(*mistake) for mistake in mistakes]

    def __reduce__(self) -> tuple[type[SceneError], tuple[str, list[Mistake]]]:
        return type(self), (self.message, self.mistakes)
