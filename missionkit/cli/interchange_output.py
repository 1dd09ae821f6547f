"""What `import`, `export` and `log` share: new files, ledgers, and places on the command line."""

from __future__ import annotations

import sys
from pathlib import Path

from missionkit.errors import UsageError, printable
from missionkit.interchange.bounded_input import number, padded
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.plan import Home


def home_of(text: str | None) -> Home | None:
    """Return the place of take-off that an option names.

    Raises:
        UsageError: it is none.
    """
    if text is None:
        return None
    parts = text.split(",")
    lat, lon, alt = padded(map(number, parts), 3)
    if lat is None or lon is None or alt is None or len(parts) != 3:
        raise UsageError(f"--home {text}: expected LAT,LON,ALT, such as 47.3977,8.5456,488")
    if abs(lat) > 90.0 or abs(lon) > 180.0 or not -1000.0 <= alt <= 10_000.0:
        raise UsageError(f"--home {text}: not a place on the earth")
    return Home(lat, lon, alt)


def require_new(out: Path, *, force: bool) -> None:
    """Refuse to replace a file or the ledger beside it, unless that is wanted.

    Raises:
        UsageError: there is one.
    """
    for path in (out, ledger_path(out)):
        if path.exists() and (not force or not path.is_file()):
            raise UsageError(f"{path}: it exists already; --force replaces it")


def ledger_path(out: Path) -> Path:
    """Return where the ledger of a file is written, beside it."""
    return out.with_name(f"{out.name}.ledger.json")


def write(path: Path, data: bytes, *, force: bool) -> None:
    """Write a file that is new, or may be replaced.

    Args:
        path: of the file.
        data: of the whole file.
        force: replace one that exists.

    Raises:
        UsageError: there is one.
    """
    try:
        with path.open("wb" if force else "xb") as stream:
            stream.write(data)
    except FileExistsError as error:
        raise UsageError(f"{path}: it exists already; --force replaces it") from error


def tell(ledger: Ledger) -> None:
    """Print a ledger on stderr."""
    for line in ledger.lines():
        print(printable(line), file=sys.stderr)  # noqa: T201
