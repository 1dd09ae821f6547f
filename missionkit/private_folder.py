"""Folders that belong to this user alone, where another user can plant nothing."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path


def runtime_folder() -> Path:
    """Return this user's folder for what lives as long as processes do; it need not exist yet.

    `XDG_RUNTIME_DIR`, or `/run/user/UID` without it (so that a service and a shell of one user
    agree), or a folder named after the user in the temporary one.
    """
    name = f"missionkit-{os.getuid()}"
    named = os.environ.get("XDG_RUNTIME_DIR")
    for base in (Path(named) if named else None, Path(f"/run/user/{os.getuid()}")):
        if base is not None and base.is_dir() and base.stat().st_uid == os.getuid():
            return base / name
    return Path(tempfile.gettempdir()) / name


def private(folder: Path) -> Path:
    """Create a folder that only this user can enter, or check that it is one; return it.

    Raises:
        PermissionError: it is a symbolic link, another user's, or open to others.
        OSError: it cannot be created.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(mode=0o700, exist_ok=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode):
        raise PermissionError(f"{folder} is not a folder: remove it")
    if found.st_uid != os.getuid():
        raise PermissionError(f"{folder} belongs to another user: have it removed")
    if stat.S_IMODE(found.st_mode) & 0o077:
        folder.chmod(0o700)
    return folder
