"""Reading a log by what it is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from missionkit.chart.text.foreign_files import ForeignKind
from missionkit.interchange.flight_logs.dataflash import read_dataflash
from missionkit.interchange.flight_logs.log_samples import FlightLog
from missionkit.interchange.flight_logs.tlog import read_tlog
from missionkit.interchange.flight_logs.ulog import read_ulog
from missionkit.interchange.ledger import Ledger

READERS: Mapping[ForeignKind, Callable[[Path], FlightLog]] = MappingProxyType(
    {
        ForeignKind.ULOG: read_ulog,
        ForeignKind.DATAFLASH: read_dataflash,
        ForeignKind.TLOG: read_tlog,
    }
)


def ledger_of(source: str, kind: ForeignKind, log: FlightLog) -> Ledger:
    """Return what became of each type of message in a log.

    Args:
        source: name of the file.
        kind: of the file.
        log: as read.
    """
    ledger = Ledger(source, str(kind))
    for name, count in sorted(log.counts.items()):
        entry = ledger.open("message", f"{name} ({count})")
        if name not in log.used:
            ledger.refuse(entry, "a record of missionkit has nothing like it")
    if log.damaged:
        ledger.refuse(ledger.open("damage", f"{log.damaged} places"), "they cannot be read")
    return ledger
