"""Numerical kernels: compiled by numba where it is installed, plain Python where it is not.

Both give the same numbers: kernels use scalar arithmetic and `math`, never fast-math.
Modules that use this are imported late, since importing numba costs a few tenths of a second.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """Compile `function` to machine code, cached beside its source."""
    try:
        from numba import njit  # noqa: PLC0415
    except ImportError:
        return function
    return cast(F, njit(cache=True)(function))
