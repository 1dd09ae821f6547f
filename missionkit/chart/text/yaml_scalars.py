"""Resolves plain YAML scalars by the core schema of YAML 1.2 (section 10.3.2).

YAML 1.1, which PyYAML follows by itself, reads `no` as false, `012` as ten and `1:30` as ninety.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

Scalar = str | int | float | bool | None

_CONSTANTS: dict[str, Scalar] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}
LEAST_FRACTION, MOST_FRACTION = 1e-12, 1e9
"""Of a number that is not whole; the squares of both are harmless."""
_NUMERIC_START = frozenset("+-.0123456789")


def resolve(text: str) -> Scalar:
    """Return what an unquoted scalar means.

    Raises:
        ValueError: a number that is not finite, does not fit in 64 bits, or is so large or small
            that sums and squares of it would not be.
    """
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if text[0] not in _NUMERIC_START:
        return text
    for pattern, convert in _NUMBER_FORMS:
        if pattern.fullmatch(text):
            return convert(text)
    return text


def _integer(digits: str, base: int = 10) -> int:
    number = int(digits, base) if len(digits) < 100 else 1 << 64
    if not -(1 << 63) <= number < 1 << 63:
        raise ValueError("a whole number must fit in 64 bits")
    return number


def _finite(text: str) -> float:
    try:
        number = float(text)
    except ValueError:  # YAML's .inf and .nan
        number = math.inf
    if math.isinf(number):
        raise ValueError(f"{text} is not a finite number")
    if number and not LEAST_FRACTION <= abs(number) <= MOST_FRACTION:
        raise ValueError(
            f"{text} is out of range: expected 0, or a size from {LEAST_FRACTION:g} "
            f"to {MOST_FRACTION:g}"
        )
    return number


_NUMBER_FORMS: tuple[tuple[re.Pattern[str], Callable[[str], Scalar]], ...] = (
    (re.compile(r"[-+]?[0-9]+"), _integer),
    (re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"), _finite),
    (re.compile(r"0o[0-7]+"), lambda text: _integer(text[2:], 8)),
    (re.compile(r"0x[0-9a-fA-F]+"), lambda text: _integer(text[2:], 16)),
    (re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"), _finite),
)
