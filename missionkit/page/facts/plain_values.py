"""Numbers, vectors and texts as JSON can say them: what is not finite becomes null."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from typing import Any

import numpy as np

DECIMALS = 6


def number(value: float | None) -> float | None:
    """Return a finite number; None stands for all others."""
    return None if value is None or not math.isfinite(value) else float(value)


def given_number(value: object) -> float | None:
    """Return a number that a browser has sent; None stands for everything else."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return None
    try:
        return number(float(value))
    except OverflowError:  # an integer of hundreds of digits
        return None


def vector(values: Any) -> list[float] | None:
    """Return the numbers of an array; None if there is none, or one of them is not finite."""
    if values is None or not np.isfinite(values).all():
        return None
    return [float(it) for it in values]


def points(rows: Iterable[Iterable[float]]) -> list[list[float]]:
    """Return points as lists."""
    return [[float(it) for it in row] for row in rows]


def text_of(value: object) -> str:
    """Return a value as JSON text."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False)
