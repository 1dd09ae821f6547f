"""Reading regular files only: a pipe or a device would wait for ever, or never end."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Callable, Mapping
from pathlib import Path

FILE_TYPES: Mapping[Callable[[int], bool], str] = {
    stat.S_ISDIR: "a folder",
    stat.S_ISFIFO: "a pipe",
    stat.S_ISSOCK: "a socket",
    stat.S_ISCHR: "a device",
    stat.S_ISBLK: "a device",
}


def irregular(path: Path) -> str:
    """Return what stands at a path instead of a file, such as `a pipe`; "": a file, or nothing.

    Raises:
        OSError: that cannot be found out.
        ValueError: it is not the name of a file.
    """
    try:
        return _kind(path.stat().st_mode)
    except FileNotFoundError:
        return ""


def read_bytes(path: Path, most: int = -1) -> bytes:
    """Return what a regular file holds, at most `most` bytes if given, without ever waiting.

    Raises:
        OSError: it cannot be opened or is not a file; the message says which.
        ValueError: it is not the name of a file.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        if kind := _kind(os.fstat(descriptor).st_mode):
            raise OSError(errno.EINVAL, f"it is {kind}, not a file", str(path))
        with os.fdopen(descriptor, "rb", closefd=False) as stream:
            return stream.read(most)
    finally:
        os.close(descriptor)


def _kind(mode: int) -> str:
    if stat.S_ISREG(mode):
        return ""
    return next((name for is_it, name in FILE_TYPES.items() if is_it(mode)), "something else")
