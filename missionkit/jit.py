"""Numerical kernels: compiled by numba where it is installed, plain Python where it is not.

Both give the same numbers: kernels use scalar arithmetic and `math`, never fast-math.
Modules that use this are imported late, since importing numba costs a few tenths of a second.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from missionkit.kernel_cache import folder_for

F = TypeVar("F", bound=Callable[..., Any])
_folder = cache(folder_for)  # found once for all kernels of a module


def compiled(function: F) -> F:
    """Compile `function` to machine code, kept in a folder named after its sources.

    Where nothing can be written it is compiled in every process; with `NUMBA_DISABLE_JIT` it stays
    plain Python.
    """
    try:
        from numba import njit  # noqa: PLC0415
        from numba.core import config  # noqa: PLC0415
    except ImportError:
        return function
    kernel, settings = njit(function), cast(Any, config)  # numba makes its settings as it loads
    folder = None if settings.DISABLE_JIT else _folder(function.__module__)
    if folder is not None:
        _cache_in(folder, kernel, settings)
    return cast(F, kernel)


def _cache_in(folder: Path, kernel: Any, config: Any) -> None:
    before, config.CACHE_DIR = config.CACHE_DIR, str(folder)
    try:
        kernel.enable_caching()
    finally:
        config.CACHE_DIR = before
    _keep_if_possible(kernel._cache)  # noqa: SLF001 - numba lets a full disk end the call


def _keep_if_possible(store: Any) -> None:
    save = store.save_overload

    def tried(signature: Any, data: Any) -> None:
        with suppress(OSError):
            save(signature, data)

    store.save_overload = tried
