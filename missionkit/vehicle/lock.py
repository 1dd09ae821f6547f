"""One process on one link: a second one would silently take the vehicle's answers away."""

from __future__ import annotations

import fcntl
import os
import tempfile
from pathlib import Path
from types import TracebackType
from typing import IO

from missionkit.errors import VehicleError
from missionkit.vehicle.address import Address


def lock_folder() -> Path:
    """Return where locks are kept: the machine's run folder of this user, or the temporary one."""
    run = os.environ.get("XDG_RUNTIME_DIR")
    base = Path(run) if run and Path(run).is_dir() else Path(tempfile.gettempdir())
    return base / f"missionkit-{os.getuid()}"


class LinkLock:
    """Holds the lock of one address; the kernel lets go of it when the process ends, however.

    Args:
        address: of the vehicle.
        folder: where lock files are.
    """

    def __init__(self, address: Address, folder: Path | None = None) -> None:
        self.path = (folder or lock_folder()) / f"{address.key}.lock"
        self._address = address
        self._file: IO[str] | None = None

    def take(self) -> None:
        """Take the lock.

        Raises:
            VehicleError: another process has it; it is named.
        """
        self.path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        file = self.path.open("a+", encoding="ascii")
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
        file.truncate(0)
        file.write(f"{os.getpid()}\n")
        file.flush()
        self._file = file

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
