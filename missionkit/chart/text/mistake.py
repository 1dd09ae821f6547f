"""One mistake in words, on its way through pydantic to the place where it belongs."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

from pydantic import ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError

from missionkit.errors import nearest

Path = tuple[int | str, ...]
MAX_HINTS = 50  # looking for the nearest of many names takes milliseconds


@dataclass(frozen=True, slots=True)
class Mistake:
    """A mistake. The known name nearest to `word` is looked up only when it is reported."""

    message: str
    word: str | None = None
    known: Collection[str] = field(default=(), repr=False)  # pydantic prints what it carries
    at_key: bool = False  # belongs to the key, not to its value

    def full(self) -> str:
        """Return the message with the nearest name and the alternatives."""
        return self.message if self.word is None else f"{self.message}; {self.hint(self.word)}"

    def hint(self, word: str) -> str:
        """Return the alternatives to `word`."""
        return nearest(word, self.known)


def sentence(
    message: str,
    *path: int | str,
    word: str | None = None,
    known: Collection[str] = (),
    at_key: bool = False,
) -> InitErrorDetails:
    """Return one error, to be raised with `sentences`, at `path` below the value validated.

    Args:
        message: without place and without remedy.
        path: keys and indices below the value validated.
        word: as written, for which the nearest of `known` is named.
        known: words that would have been right.
        at_key: whether the place is that of the key, instead of its value.
    """
    return carried(Mistake(message, word, known, at_key), path)


def carried(cause: Mistake, path: Path) -> InitErrorDetails:
    """Return a sentence as pydantic carries it."""
    error = PydanticCustomError(
        "mistake", "{message}", {"message": cause.message, "sentence": cause}
    )
    return InitErrorDetails(type=error, loc=path, input=None)


def sentences(*errors: InitErrorDetails) -> ValidationError:
    """Return the exception that carries errors through pydantic with their paths."""
    return ValidationError.from_exception_data("mission", list(errors))
