"""One process on one link: a second one would silently take the vehicle's answers away."""

from __future__ import annotations

import fcntl
import os
import stat
import threading
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO

from missionkit.errors import VehicleError
from missionkit.private_folder import private, runtime_folder
from missionkit.vehicle.guardian import HOLDER
from missionkit.vehicle.link.clocks import wall
from missionkit.vehicle.link.link_address import Address

FINISHING = 12.0  # s to wait for a guardian without a mission
SIGNED = 0.3  # s until a guardian has noticed that its mission is gone


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
            VehicleError: another process, which is named, has it, or there is no safe place for it.
        """
        try:
            file = _own_file(self.path)
        except OSError as error:
            raise VehicleError(f"the lock of {self._address.url} cannot be used: {error}") from None
        holder = _locked(file)
        if holder:
            file.close()
            raise VehicleError(
                f"{self._address.url} is in use by another missionkit (process {holder}): "
                "two on one link steal each other's replies; stop that one first"
            ) from None
        self._file = file
        with suppress(OSError):  # a full disk: who holds it is for the message alone
            file.seek(0)
            file.truncate()
            file.write(f"{os.getpid()}\n")
            file.flush()

    @property
    def descriptor(self) -> int:
        """The file that holds the lock, for a guardian to hold it as well.

        Raises:
            VehicleError: it is not taken.
        """
        if self._file is None:
            raise VehicleError(f"the lock of {self._address.url} is not taken")
        return self._file.fileno()

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


def _locked(file: IO[str]) -> str:
    """Lock a file; return "", or who has it.

    A guardian whose mission is gone lets go as soon as the vehicle holds: it is waited for.
    """
    begun = wall()
    while True:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.seek(0)
            holder = file.read().strip() or "unknown"
        else:
            return ""
        if wall() - begun > (FINISHING if holder.startswith(HOLDER) else SIGNED):
            return holder
        threading.Event().wait(0.05)


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
