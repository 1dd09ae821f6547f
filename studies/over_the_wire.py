"""The precision task over MAVLink, graded by the truth: `python -m studies.over_the_wire`."""

from __future__ import annotations

import argparse
import json
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from missionkit.api.vehicle_flight import fly_vehicle, vehicle_of
from missionkit.chart.plugin_catalogue import builtin
from missionkit.messages import Observation, Record
from missionkit.rehearsal.stage import Stage, stage
from missionkit.sim.flight_grading import Grade, grade
from studies.flight import Camera, Order, staged
from studies.leaning import knowing_noise, sih, with_small_markers
from studies.markdown import table
from studies.statistics import wilson

DIALECTS = ("px4", "ardupilot")
TITLE = """# Study: the precision task over MAVLink

`missionkit sitl` in a process of its own, flown through MAVSDK by the engine in another, graded by
the truth of the simulated autopilot.
"""
SECTION = """
## {heading}

Camera {camera}, {speed:g} times real time.

    {command}

{rows}
"""


class Setting(NamedTuple):
    """The vehicle, the wind and the faults of a group of flights."""

    says: str
    wind: tuple[float, float, float] | None = None  # m/s, NED: PX4's simulated vehicle, steady wind
    faults: tuple[str, ...] = ()  # from the start
    in_visual: tuple[str, ...] = ()  # from the first entry to the state visual
    small_markers: bool = False  # two more


WRONG = ("velocity_bias", "control_slow")
LOST = ("stream_lost",)
STEADY = (1.5, 1.0, 0.0)  # m/s, the orchard's mean
SETTINGS = {
    "plain": Setting("the simulator's vehicle"),
    "sih": Setting("PX4's simulated vehicle, calm air", (0.0, 0.0, 0.0), WRONG),
    "wind": Setting("the same, 1.8 m/s, small markers", STEADY, WRONG, small_markers=True),
    "lost": Setting("the same, LOCAL_POSITION lost", STEADY, WRONG, LOST, small_markers=True),
}


class Autopilot:
    """The control socket of a simulated autopilot."""

    def __init__(self, port: int) -> None:
        self._file = socket.create_connection(("127.0.0.1", port)).makefile("rw")

    def ask(self, **request: Any) -> Any:
        """Return the answer to one request."""
        self._file.write(json.dumps(request) + "\n")
        self._file.flush()
        return json.loads(self._file.readline())


class Flown(NamedTuple):
    """One flight over the wire."""

    setting: str
    dialect: str
    seed: int
    end: str
    grade: Grade
    finished: bool  # the work


class Spans:
    """Records when each state was entered and left, in the simulator's time.

    Args:
        autopilot: the simulator's own.
        in_visual: faults from the first entry to the state visual.
    """

    def __init__(self, autopilot: Autopilot, in_visual: Sequence[str] = ()) -> None:
        self.spans: dict[str, tuple[float, float]] = {}
        self.finished = False
        self._autopilot, self._in_visual = autopilot, in_visual
        self._state = ""

    def __call__(self, record: Record, _: Observation) -> None:
        """Take in one tick."""
        if record.state != self._state:
            now = float(self._autopilot.ask(time=True)["time"])
            if self._state:
                self.spans[self._state] = (self.spans[self._state][0], now)
            if record.state == "visual" and "visual" not in self.spans:
                for fault in self._in_visual:
                    self._autopilot.ask(fault=fault)
            self.finished |= (self._state, record.state) == ("task", "return")
            self._state = record.state
            self.spans.setdefault(record.state, (now, now))


@contextmanager
def sitl(
    world: str | None,
    dialect: str,
    port: int,
    speed: float,
    seed: int,
    more: Sequence[str] = (),
) -> Iterator[Autopilot]:
    """Run a simulated autopilot, with `more` options, while this context is open."""
    line = [sys.executable, "-m", "missionkit", "sitl", "--dialect", dialect]
    line += [] if world is None else ["--world", world]
    line += ["--link", f"udpout:127.0.0.1:{port}", "--speed", f"{speed:g}", "--seed", str(seed)]
    process = subprocess.Popen([*line, *more, "--json"], stdout=subprocess.PIPE, text=True)  # noqa: S603
    with process:
        try:
            said = process.stdout.readline() if process.stdout is not None else "{}"
            yield Autopilot(json.loads(said)["control"])
        finally:
            process.terminate()


def free_port() -> int:
    """Return a free UDP port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def placed(named: Setting, seed: int, camera: Camera) -> Stage:
    """Set up one flight; the faults are the autopilot's."""
    ready = staged(Order(seed, camera))
    mission, world = ready.mission, ready.world
    if named.wind is not None:  # PX4's simulated vehicle
        mission, world = knowing_noise(mission), sih(world, named.wind, 0.0)
    if named.small_markers:
        mission, world = with_small_markers(mission, world)
    return stage(mission, builtin(), world, seed)


def flown(name: str, dialect: str, seed: int, camera: Camera, speed: float) -> Flown:
    """Fly the task once."""
    named, port = SETTINGS[name], free_port()
    ready = placed(named, seed, camera)
    mission = ready.mission
    options = [part for fault in named.faults for part in ("--fault", fault)]
    with TemporaryDirectory() as folder:
        world = Path(folder) / "world.yaml"
        world.write_text(ready.world.model_dump_json(), encoding="utf-8")
        with sitl(str(world), dialect, port, speed, seed, options) as autopilot:
            spans = Spans(autopilot, named.in_visual)
            address = f"udpin://127.0.0.1:{port}"
            vehicle = vehicle_of(address, mission, ready.world, seed=seed, speed=speed)
            limit = mission.settings.time_limit
            end = fly_vehicle(ready.plan, vehicle, (spans,), speed=speed, time_limit=limit).end
            rows = np.array(autopilot.ask(track=True, since=0.0, every=1)["rows"], dtype=float)
    marker, span = ready.world.marker(23, "DICT_6X6_250"), spans.spans.get("task")
    graded = grade(rows, mission.success[0], marker, span)
    return Flown(name, dialect, seed, str(end), graded, spans.finished)


def row(flights: Sequence[Flown]) -> tuple[str, ...]:
    """Return the results of one dialect in one setting as a row of the table."""
    good = sum(flight.grade.succeeded for flight in flights)
    visits = [flight.grade.visit for flight in flights if flight.grade.visit is not None]
    errors = [100.0 * visit.position_error for visit in visits] or [float("nan")]
    yaws = [float(np.degrees(visit.yaw_error or 0.0)) for visit in visits] or [float("nan")]
    low, high = wilson(good, len(flights))
    return (
        SETTINGS[flights[0].setting].says,
        flights[0].dialect,
        f"{good} of {len(flights)}",
        f"{sum(flight.finished for flight in flights)} of {len(flights)}",
        f"{100.0 * low:.0f} to {100.0 * high:.0f} %",
        f"{median(errors):.1f} ({max(errors):.1f})",
        f"{median(yaws):.1f} ({max(yaws):.1f})",
    )


HEADER = (
    "what is flown",
    "dialect",
    "success",
    "work finished",
    "95 %",
    "error on arrival, cm (most)",
    "heading, deg (most)",
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly the precision task over the wire in both dialects, and write up the results."""
    parser = argparse.ArgumentParser(prog="python -m studies.over_the_wire")
    parser.add_argument("--flights", type=int, default=10, help="in each setting and dialect")
    parser.add_argument("--first", type=int, default=1, metavar="SEED")
    parser.add_argument("--settings", nargs="+", choices=tuple(SETTINGS), default=["plain"])
    parser.add_argument("--camera", choices=("rendered", "corners"), default="corners")
    parser.add_argument("--speed", type=float, default=3.0, help="times real time")
    parser.add_argument("--add", action="store_true", help="append to the page")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    rows = []
    for name in chosen.settings:
        for dialect in DIALECTS:
            flights = []
            for seed in range(chosen.first, chosen.first + chosen.flights):
                flight = flown(name, dialect, seed, chosen.camera, chosen.speed)
                print(*flight[:4], flight.finished, flight.grade.visit, flush=True)  # noqa: T201
                flights.append(flight)
            rows.append(row(flights))
    command = (
        f"python -m studies.over_the_wire --flights {chosen.flights} --first {chosen.first} "
        f"--settings {' '.join(chosen.settings)} --camera {chosen.camera} --speed {chosen.speed:g}"
    ) + (" --add" if chosen.add else "")
    text = SECTION.format(
        heading="With faults" if chosen.add else "As it is",
        camera=chosen.camera,
        speed=chosen.speed,
        command=command,
        rows=table(HEADER, rows),
    )
    page = chosen.out / "over_the_wire.md"
    before = page.read_text(encoding="utf-8") if chosen.add else TITLE
    page.write_text(before + text, encoding="utf-8")
    print(text)  # noqa: T201


if __name__ == "__main__":
    main()
