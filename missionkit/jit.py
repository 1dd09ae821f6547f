"""Numerical kernels: compiled by numba where it is installed, plain Python where it is not.

Both give the same numbers: kernels use scalar arithmetic and `math`, never fast-math.
numba is imported when the first kernel is called: it costs a few tenths of a second, which a
command that flies nothing does not pay. What flies calls its kernels once before take-off.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cache, update_wrapper
from pathlib import Path
from typing import Any, TypeVar, cast

from typing_extensions import override

from missionkit.kernel_cache import folder_for

F = TypeVar("F", bound=Callable[..., Any])
_folder = cache(folder_for)  # found once for all kernels of a module


def compiled(function: F) -> F:
    """Compile `function` to machine code at its first call.

    It is kept in a folder named after its source. Where nothing can be written it is compiled in
    every process; with `NUMBA_DISABLE_JIT` it stays plain Python.
    """
    return cast(F, update_wrapper(Kernel(function), function))


class Kernel:
    """A function that becomes machine code when it is first called, or called by another kernel."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function
        self._made: Callable[..., Any] | None = None

    def __call__(self, *arguments: Any) -> Any:
        """Return what the function returns."""
        return (self._made or self.made())(*arguments)

    def made(self) -> Any:
        """Return what numba makes of the function, the function itself where there is no numba."""
        if self._made is None:
            self._made = _made(self._function)
        return self._made

    @property
    def _numba_type_(self) -> Any:
        """The type by which numba knows it where a kernel calls it or is given it."""
        return self.made()._numba_type_

    @override
    def __reduce__(self) -> str:
        """Pickle it by its name."""
        return self._function.__qualname__

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of what numba makes of it, such as `py_func`."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.made(), name)


def _made(function: Callable[..., Any]) -> Any:
    try:
        from numba import njit  # noqa: PLC0415
        from numba.core import config  # noqa: PLC0415
    except ImportError:
        return function
    kernel = cast(Any, njit)(no_cfunc_wrapper=True)(function)  # nothing calls kernels from C
    settings = cast(Any, config)  # numba makes its settings as it loads
    folder = None if settings.DISABLE_JIT else _folder(function.__module__)
    if folder is not None:
        _cache_in(folder, kernel, settings)
    return kernel


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
