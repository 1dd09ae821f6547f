"""One process on one link: a second one would silently take the vehicle's answers away."""

from __future__ import annotations

import fcntl
import os
import stat
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO

from missionkit.errors import VehicleError
from missionkit.private_folder import private, runtime_folder
from missionkit.vehicle.address import Address


class LinkLock:
    """Holds the lock of one address; the kernel lets go of it when the process ends, however.

    Args:
        address: of the vehicle.
        folder: where lock files are; made private to this user.
    """

    def __init__(self, address: Address, folder: Path | None = None) -> None:
        self.path = (folder or runtime_folder()) / f"{address.key}.lock"
        self._address = address
        self._file: IO[str] | None = None

    def take(self) -> None:
        """Take the lock.

        Raises:
            VehicleError: another process has it, which is named, or there is no safe place for it.
        """
        try:
            file = _own_file(self.path)
        except OSError as error:
            raise VehicleError(f"the lock of {self._address.url} cannot be used: {error}") from None
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.seek(0)
            holder = file.read().strip() or "unknown"
            file.close()
            raise VehicleError(
                f"{self._address.url} is in use by another missionkit (process {holder}): "
                "two on one link take each other's answers away; end that one first"
            ) from None
        self._file = file
        with suppress(OSError):  # a full disk: who holds it is for the message alone
            file.truncate(0)
            file.write(f"{os.getpid()}\n")
            file.flush()

    def release(self) -> None:
        """Let go of the lock. The file stays: removing it would let two processes in."""
        file, self._file = self._file, None
        if file is not None:
            file.close()

    def __enter__(self) -> LinkLock:
        self.take()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.release()


def _own_file(path: Path) -> IO[str]:
    """Open a file of this user's for reading and writing; what it holds stays.

    Raises:
        OSError: its folder is not private, or it is a symbolic link or another user's.
    """
    private(path.parent)
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    file = os.fdopen(os.open(path, flags, 0o600), "r+", encoding="ascii", errors="replace")
    found = os.fstat(file.fileno())
    if not stat.S_ISREG(found.st_mode) or found.st_uid != os.getuid():
        file.close()
        raise PermissionError(f"{path} is not a file of this user: remove it")
    return file
