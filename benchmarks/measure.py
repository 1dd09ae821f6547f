"""Timing, and the table that comes of it."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple, ParamSpec, TypeVar

import numpy as np

from missionkit.engine.clock import stopwatch

P = ParamSpec("P")
T = TypeVar("T")


class Table(NamedTuple):
    """Result of one benchmark."""

    title: str
    header: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    note: str = ""


class Took(NamedTuple):
    """Time on the wall and on the processor (s)."""

    wall: float
    cpu: float


def timed(work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> tuple[T, Took]:
    """Call `work` once; return what it returned and how long it took, all threads counted."""
    wall, cpu = stopwatch(), time.process_time()
    result = work(*args, **kwargs)
    return result, Took(stopwatch() - wall, time.process_time() - cpu)


def seconds(work: Callable[P, object], *args: P.args, **kwargs: P.kwargs) -> float:
    """Call `work` once; return the processor time it took (s), other processes left out."""
    return timed(work, *args, **kwargs)[1].cpu


def spread(times: Sequence[float], scale: float, digits: int) -> tuple[str, str]:
    """Return median and 99th percentile of times (s) as text, `scale` to the second."""
    p50, p99 = np.percentile(times, (50, 99))
    return f"{scale * p50:.{digits}f}", f"{scale * p99:.{digits}f}"


def installed(name: str, package: str) -> bool:
    """Say whether a package can be imported; if not, say that `name` is left out."""
    try:
        import_module(package.replace("scikit-image", "skimage"))
    except ModuleNotFoundError as error:
        print(f"left out: {name} ({error}); make bench installs it")
        return False
    return True


def version_of(package: str) -> str:
    """Return a blank and the version of another package, "" for missionkit."""
    return "" if package == "missionkit" else f" {version(package)}"


def machine() -> str:
    """Describe the machine and how busy it is."""
    load = os.getloadavg()[0]
    cores = os.cpu_count()
    return f"{_processor()}, {cores} cores, load {load:.1f}; Python {platform.python_version()}"


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    for line in info.read_text(encoding="utf-8").splitlines() if info.exists() else ():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()
