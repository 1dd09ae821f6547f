"""`--vary param=a,b,c`: variants of a mission that are flown on the same random numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import product

from missionkit.errors import UsageError

Axis = tuple[str, tuple[str, ...]]
"""A parameter and the values it takes."""


def axis(text: str) -> Axis:
    """Read one `--vary` option; commas inside brackets belong to a value.

    >>> axis("cruise=4,5.5")
    ('cruise', ('4', '5.5'))
    >>> axis("offset=[1,2],[3,4]")
    ('offset', ('[1,2]', '[3,4]'))

    Raises:
        UsageError: it is not of the form NAME=VALUE,VALUE.
    """
    name, equals, rest = text.partition("=")
    values = tuple(value.strip() for value in _split(rest))
    if not (name and equals and all(values)):
        raise UsageError(f"--vary {text}: expected NAME=VALUE,VALUE, as in cruise=4,5,6")
    if len(set(values)) < len(values):
        raise UsageError(f"--vary {text}: a value is listed twice")
    return name, values


def _split(text: str) -> list[str]:
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "[{") - (letter in "]}")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def axes(texts: Iterable[str], fixed: Iterable[str] = ()) -> tuple[Axis, ...]:
    """Read all `--vary` options.

    Raises:
        UsageError: one is wrong, or a parameter is given twice.
    """
    read, taken = [], set(fixed)
    for name, values in map(axis, texts):
        if name in taken:
            raise UsageError(f"--vary {name}: the parameter is already set")
        taken.add(name)
        read.append((name, values))
    return tuple(read)


def variants(over: Sequence[Axis]) -> tuple[Mapping[str, str], ...]:
    """Return the settings of every combination, the last parameter changing fastest."""
    names = [name for name, _ in over]
    choices = product(*(values for _, values in over))
    return tuple(dict(zip(names, chosen, strict=True)) for chosen in choices)


def name_of(settings: Mapping[str, str]) -> str:
    """Return a variant in words."""
    return ", ".join(f"{name} = {value}" for name, value in settings.items()) or "as written"
