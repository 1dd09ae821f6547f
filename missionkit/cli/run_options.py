"""Options of `missionkit run`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from missionkit.page.server.binding import Binding
    from missionkit.vehicle.link.traffic_link import FleetPlace

DEFAULT_GAP = 1.0  # s


class RunOptions(NamedTuple):
    """One flight."""

    mission: Path
    settings: tuple[str, ...]
    plugins: tuple[Path, ...]
    seed: int
    faults: tuple[str, ...]
    speed: float | None
    out: Path
    headless: bool
    as_json: bool
    vehicle: str | None = None  # address; the simulator if absent
    system: int | None = None  # MAVLink system id, where several vehicles share the link
    source: str | None = None  # of a real camera, or "rendered"
    share: tuple[str, ...] = ()  # estimates to send to the vehicle: "pose", "target=NAME"
    events: tuple[str, ...] = ()  # from the operator, NAME@WHEN
    resume: Path | None = None  # the folder of the run to resume
    gap: float = DEFAULT_GAP  # s that the simulated vehicle flew alone
    force: bool = False  # also with another mission
    sitl: str | None = None  # dialect of a simulated autopilot to start, fly and end
    folder: Path | None = None  # of the run, made already; one under `out` if absent
    place: FleetPlace | None = None  # in the fleet that it flies in
    anyway: bool = False  # takes off although a failsafe or the pre-flight report says no
    page: Binding | None = None  # where the flight's page is served; None: it has none
