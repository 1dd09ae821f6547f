"""The folder of one run: a new one, or that of a run that is gone on with; what is left there."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Protocol, TypeVar

from missionkit.chart.model.mission import Mission
from missionkit.cli.order import Order
from missionkit.cli.origin import (
    Origin,
    check_same,
    forget_origin,
    keep_origin,
    origin_of,
    stamp,
)
from missionkit.cli.outcome import numbers
from missionkit.engine.flight import Plan
from missionkit.recorder.checkpoint import Loaded
from missionkit.recorder.flight import FlightRecorder
from missionkit.recorder.folder import free_name, keep_mission, run_folder
from missionkit.recorder.plot import draw
from missionkit.recorder.scenery import Scenery
from missionkit.recorder.summary import Summary, write_summary
from missionkit.recorder.track import Track


class Past(Protocol):
    """What a run goes on from."""

    @property
    def loaded(self) -> Loaded:
        """The checkpoint."""

    @property
    def track(self) -> Track:
        """What was flown so far."""


P = TypeVar("P", bound=Past)


class Folder(NamedTuple):
    """Where a run leaves its files."""

    path: Path
    stamp: str  # of what the flight stands on

    def recorder(self, plan: Plan, scenery: Scenery, past: Past | None) -> FlightRecorder:
        """Return what records the flight, beside the records that are there already."""
        return FlightRecorder(
            self.path,
            camera=plan.camera,
            scenery=scenery,
            name=free_name(self.path, "flight.mcap"),
            past=None if past is None else past.track,
        )

    def finish(self, summary: Summary, track: Track, scenery: Scenery) -> None:
        """Leave the summary and the picture; there is nothing to go on with any more."""
        write_summary(self.path, summary)
        title = f"{summary.mission}: {summary.outcome}"
        draw(self.path / "track.png", track, scenery, title, numbers(summary))
        forget_origin(self.path)


def folder_of(
    order: Order,
    mission: Mission,
    before: Origin | None,
    label: str,
    found: Callable[[Path, str], P],
) -> tuple[Folder, P | None]:
    """Return the folder of a run, and what it goes on from.

    Args:
        order: of the command line.
        mission: that is flown.
        before: what a run that is gone on with was started from.
        label: ends the name of a new folder.
        found: reads the checkpoint of a folder, given the stamp of the mission as it is now.

    Raises:
        UsageError: the mission was changed, or there is no checkpoint to go on from.
    """
    origin, past = origin_of(order, mission), None
    if before is None or order.resume is None:
        path = run_folder(order.out, mission.name, label)
    else:
        path = order.resume
        check_same(before, origin, path, force=order.force)
        past = found(path, stamp(origin))
        for wrong in past.loaded.wrong:
            print(wrong, file=sys.stderr)  # noqa: T201
    if before != origin:
        keep_mission(path, order.mission)
        keep_origin(path, origin)
    return Folder(path, stamp(origin)), past
