"""Numbers in messages, with as many digits as it takes to see why they are compared."""

from __future__ import annotations

import math
from collections.abc import Iterator

MOST_DIGITS = 15


def beside(value: float, limit: float, places: int) -> tuple[str, str]:
    """Return a value and its limit so that the texts compare as the numbers do.

    >>> beside(0.52, 0.1, 2), beside(0.1004, 0.1, 2), beside(0.1, 0.1, 2)
    (('0.52', '0.1'), ('0.1004', '0.1'), ('0.10', '0.1'))

    Args:
        value: what was measured.
        limit: what it is compared with.
        places: decimals of `value` at least.
    """
    return next(_texts(value, limit, places, "f"))


def beside_short(value: float, limit: float, digits: int) -> tuple[str, str]:
    """Return a value and its limit with `digits` significant digits or more, as `beside` does.

    Args:
        value: what was measured.
        limit: what it is compared with.
        digits: significant ones of `value` at least.

    >>> beside_short(0.698, 0.7, 2), beside_short(12.34, 7.0, 3)
    (('0.698', '0.7'), ('12.3', '7'))
    """
    return next(_texts(value, limit, digits, "g"))


def _texts(value: float, limit: float, least: int, style: str) -> Iterator[tuple[str, str]]:
    wanted = _order(value, limit)
    for digits in range(least, MOST_DIGITS + 1):
        shown = f"{value:.{digits}{style}}"
        for border in (f"{limit:g}", f"{limit:.{digits}{style}}"):
            if _order(float(shown), float(border)) == wanted:
                yield shown, border
    yield repr(value), repr(limit)


def _order(value: float, limit: float) -> int:
    return (value > limit) - (value < limit)


def rounded_up(value: float, places: int) -> str:
    """Return the least number of so many decimals that is not below `value`, for "at least".

    >>> rounded_up(1.241, 2), rounded_up(1.2, 2), rounded_up(0.1 + 0.2, 2)
    ('1.25', '1.2', '0.3')
    """
    return f"{math.ceil(value * 10**places - 1e-9) / 10**places:g}"


def rounded_down(value: float, places: int) -> str:
    """Return the largest number of so many decimals that is not above `value`, for "at most".

    >>> rounded_down(0.349, 2), rounded_down(0.3, 2)
    ('0.34', '0.3')
    """
    return f"{math.floor(value * 10**places + 1e-9) / 10**places:g}"
