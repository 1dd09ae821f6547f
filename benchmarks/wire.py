"""Over MAVLink, on loopback in real time: how evenly setpoints come, how long commands take."""

from __future__ import annotations

import asyncio
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from benchmarks.flights import ready
from benchmarks.measure import Table, timed
from missionkit.api.vehicle_flight import fly_vehicle, vehicle_of
from missionkit.engine.clock import stopwatch
from missionkit.geometry import vec
from missionkit.messages import Action, Command, Observation, Record, Setpoint
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.guardian.policy import USUAL, Patience
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from studies.over_the_wire import DIALECTS, Autopilot, free_port, sitl

PERIOD = 0.05  # s
CHANGES = 20  # of mode, there and back
PATIENCE = 30.0  # s
Change = tuple[Command, str]  # and the mode that comes of it
REST = Command()
CLIMB = Command(Setpoint(vec(0.0, 0.0, -1.0), 0.0))
UP = Command(action=Action.TAKE_OFF)
LAND = Command(action=Action.LAND)
PAIRS = {
    "px4": ((CLIMB, "offboard"), (REST, "hold")),
    "ardupilot": ((CLIMB, "guided"), (LAND, "land")),  # it holds in the mode that it is flown in
}


def tables() -> list[Table]:
    """Fly the precision task, then change modes."""
    return [_cadences(), _latencies()]


class Stream(NamedTuple):
    """The setpoints of one flight, as they came to the autopilot."""

    gaps: np.ndarray  # s
    oldest: float  # s since the tick that gave it
    cpu: float  # s of the processor in one of the wall


def _cadences() -> Table:
    rows = [
        _row("drawn camera, one core left idle", _stream(busy=0)),
        _row("the same without a guardian", _stream(busy=0, guard=None)),
        _row("drawn camera, one core busy", _stream(busy=1)),
        _row("the same without a guardian", _stream(busy=1, guard=None)),
    ]
    note = (
        "One precision task each with PX4's dialect, the simulated autopilot in a process of its "
        "own: gaps at the autopilot between setpoints at 20 Hz, while it is commanded. Oldest: "
        "since the tick that gave it; 0.5 s is never passed. Processor: of one core, the guardian "
        "counted, with drawing and looking for markers at 20 Hz."
    )
    header = ("flight", "setpoints", "p50, ms", "p99, ms", "most, ms", "oldest, ms", "processor")
    return Table("Over MAVLink: setpoints", header, rows, note)


def _row(name: str, stream: Stream) -> tuple[str, ...]:
    p50, p99 = 1e3 * np.percentile(stream.gaps, (50, 99))
    most, oldest = 1e3 * stream.gaps.max(), 1e3 * stream.oldest
    figures = f"{p50:.1f}", f"{p99:.1f}", f"{most:.1f}", f"{oldest:.1f}"
    return name, str(len(stream.gaps) + 1), *figures, f"{100.0 * stream.cpu:.0f} %"


def _stream(busy: int, guard: Patience | None = USUAL) -> Stream:
    at, port, ticks = ready("rendered"), free_port(), list[float]()

    def tick(_: Record, __: Observation) -> None:
        ticks.append(stopwatch())

    with sitl(f"missions/{at.mission.world}", "px4", port, 1.0, 0) as autopilot, _load(busy):
        vehicle = vehicle_of(f"udpin://127.0.0.1:{port}", at.mission, at.world, guard=guard)
        before = _children()
        _, took = timed(fly_vehicle, at.plan, vehicle, (tick,))
        guarding = _children() - before  # the others have not ended yet
        came = _setpoints(autopilot)
    given = np.searchsorted(ticks, came) - 1
    oldest = max(came - np.array(ticks)[np.maximum(given, 0)])
    return Stream(np.diff(came), float(oldest), (took.cpu + guarding) / took.wall)


def _children() -> float:
    """Return the processor time (s) of child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _setpoints(autopilot: Autopilot) -> np.ndarray:
    """Return when setpoints came (s, wall) between entering Offboard and leaving it.

    Raises:
        RuntimeError: it was never in Offboard, or never left it.
    """
    modes = autopilot.ask(journal="mode", since=0.0)["notes"]
    begin = next((note["wall"] for note in modes if note["which"] == "OFFBOARD"), None)
    end = next((note["wall"] for note in modes if begin and note["wall"] > begin), None)
    if begin is None or end is None:
        raise RuntimeError(f"Offboard was not entered and left: {[it['which'] for it in modes]}")
    notes = autopilot.ask(journal="setpoint", since=0.0)["notes"]
    return np.array([note["wall"] for note in notes if begin <= note["wall"] <= end])


@contextmanager
def _load(processes: int) -> Iterator[None]:
    """Keep so many cores busy while this context is open."""
    line = [sys.executable, "-c", "while True: pass"]
    busy = [subprocess.Popen(line) for _ in range(processes)]
    try:
        yield
    finally:
        for process in busy:
            process.kill()
            process.wait()


class Waits(NamedTuple):
    """How long every change took (s)."""

    acks: list[float]
    changed: list[float]  # until the autopilot was in the mode
    seen: list[float]  # until telemetry said so


def _latencies() -> Table:
    rows = [row for dialect in DIALECTS for row in _waits(dialect)]
    note = (
        f"{CHANGES} times there and back between offboard and hold (PX4), guided and land "
        "(ArduPilot). From the tick that wants it; to the answer: from sending "
        "the command to its acknowledgement. Telemetry shows a mode in the heartbeat, once a "
        "second."
    )
    return Table("Over MAVLink: commands", ("dialect", "time", "p50, ms", "p99, ms"), rows, note)


def _waits(dialect: str) -> Iterator[tuple[str, ...]]:
    port = free_port()
    with sitl("missions/worlds/orchard.yaml", dialect, port, 1.0, 0) as autopilot:
        waits = asyncio.run(_changes(f"udpin://127.0.0.1:{port}", autopilot, PAIRS[dialect]))
    for name, times in (
        ("to the answer", waits.acks),
        ("until the mode has changed", waits.changed),
        ("until telemetry shows it", waits.seen),
    ):
        p50, p99 = 1e3 * np.percentile(times, (50, 99))
        yield dialect, name, f"{p50:.1f}", f"{p99:.1f}"


async def _changes(url: str, autopilot: Autopilot, pair: Sequence[Change]) -> Waits:
    vehicle, waits = MavsdkVehicle(parse(url)), Waits([], [], [])
    await vehicle.connect()
    try:
        flight = _Flight(vehicle)
        state = vehicle.state
        await flight.until(lambda: state.ready)
        await flight.until(lambda: bool(state.armed), Command(action=Action.ARM))
        await flight.until(lambda: (state.height or 0.0) > 2.2, UP)
        for number in range(2 * CHANGES):
            command, word = pair[1 - number % 2]
            begun = flight.due
            await flight.until(_shows(state, word), command)
            waits.seen.append(stopwatch() - begun)
            mode = autopilot.ask(journal="mode", since=0.0)["notes"][-1]
            waits.changed.append(mode["wall"] - begun)
            await flight.rest(0.3 + 0.618 * number % 1.0, command)  # in no step with heartbeats
        took = (report.result.took for report in vehicle.reports)
        waits.acks.extend(seconds for seconds in took if seconds is not None)
    finally:
        await vehicle.close()
    return waits


def _shows(state: AutopilotState, word: str) -> Callable[[], bool]:
    return lambda: state.mode == word


class _Flight:
    """A vehicle that is ticked at 20 Hz."""

    def __init__(self, vehicle: MavsdkVehicle) -> None:
        self._vehicle = vehicle
        self._start = stopwatch()
        self._count = 0

    @property
    def due(self) -> float:
        """When the next tick is due (s, wall)."""
        return self._start + (self._count + 1) * PERIOD

    async def until(self, holds: Callable[[], bool], command: Command = REST) -> None:
        """Tick until something holds."""
        limit = stopwatch() + PATIENCE
        while not holds():
            if stopwatch() > limit:
                raise TimeoutError
            await self._tick(command)

    async def rest(self, seconds: float, command: Command) -> None:
        """Tick for a while."""
        for _ in range(round(seconds / PERIOD)):
            await self._tick(command)

    async def _tick(self, command: Command) -> None:
        await asyncio.sleep(max(0.0, self.due - stopwatch()))
        self._count += 1
        await self._vehicle.observe(self._count * PERIOD)
        await self._vehicle.send(command)
