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
from typing import Any, NamedTuple

import numpy as np

from missionkit.cli.fly import fly_vehicle, vehicle_of
from missionkit.messages import Observation, Record
from missionkit.sim.grade import Grade, grade
from studies.flight import Camera, Order, staged
from studies.markdown import table
from studies.statistics import wilson

DIALECTS = ("px4", "ardupilot")
PAGE = """# Study: the precision task over MAVLink

`missionkit sitl` in a process of its own, flown through MAVSDK by the engine in another, camera
{camera}, {speed:g} times real time, graded by the truth of the simulated autopilot.

    {command}

{rows}
"""


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

    dialect: str
    seed: int
    end: str
    grade: Grade


class Spans:
    """When each state was entered and left, in the simulator's time."""

    def __init__(self, autopilot: Autopilot) -> None:
        self.spans: dict[str, tuple[float, float]] = {}
        self._autopilot = autopilot
        self._state = ""

    def __call__(self, record: Record, _: Observation) -> None:
        """Take in one tick."""
        if record.state != self._state:
            now = float(self._autopilot.ask(time=True)["time"])
            if self._state:
                self.spans[self._state] = (self.spans[self._state][0], now)
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
    """Return a port that nobody listens to."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def flown(dialect: str, seed: int, camera: Camera, speed: float) -> Flown:
    """Fly the task once."""
    ready, port = staged(Order(seed, camera)), free_port()
    mission = ready.mission
    with sitl(f"missions/{mission.world}", dialect, port, speed, seed) as autopilot:
        spans = Spans(autopilot)
        address = f"udpin://127.0.0.1:{port}"
        vehicle = vehicle_of(address, mission, ready.world, seed=seed, speed=speed)
        limit = mission.settings.time_limit
        end = fly_vehicle(ready.plan, vehicle, (spans,), speed=speed, time_limit=limit).end
        rows = np.array(autopilot.ask(track=True, since=0.0, every=1)["rows"], dtype=np.float64)
    marker, span = ready.world.marker(23, "DICT_6X6_250"), spans.spans.get("task")
    return Flown(dialect, seed, str(end), grade(rows, mission.success[0], marker, span))


def row(dialect: str, flights: Sequence[Flown]) -> tuple[str, ...]:
    """Return what a dialect's flights came to."""
    good = sum(flight.grade.succeeded for flight in flights)
    visits = [flight.grade.visit for flight in flights if flight.grade.visit is not None]
    errors = [100.0 * visit.position_error for visit in visits] or [float("nan")]
    yaws = [float(np.degrees(visit.yaw_error or 0.0)) for visit in visits] or [float("nan")]
    low, high = wilson(good, len(flights))
    return (
        dialect,
        f"{good} of {len(flights)}",
        f"{100.0 * low:.0f} to {100.0 * high:.0f} %",
        f"{median(errors):.1f} ({max(errors):.1f})",
        f"{median(yaws):.1f} ({max(yaws):.1f})",
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly the precision task over the wire in both dialects, and write up what came of it."""
    parser = argparse.ArgumentParser(prog="python -m studies.over_the_wire")
    parser.add_argument("--flights", type=int, default=10, help="in each dialect")
    parser.add_argument("--camera", choices=("rendered", "corners"), default="corners")
    parser.add_argument("--speed", type=float, default=3.0, help="times real time")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    flights = []
    for dialect in DIALECTS:
        for seed in range(1, chosen.flights + 1):
            flight = flown(dialect, seed, chosen.camera, chosen.speed)
            print(dialect, seed, flight.end, flight.grade.visit, flush=True)  # noqa: T201
            flights.append(flight)
    header = ("dialect", "success", "95 %", "error on arrival, cm (most)", "heading, deg (most)")
    by_dialect = [[flight for flight in flights if flight.dialect == name] for name in DIALECTS]
    told = table(header, [row(each[0].dialect, each) for each in by_dialect])
    command = (
        f"python -m studies.over_the_wire --flights {chosen.flights} --camera {chosen.camera} "
        f"--speed {chosen.speed:g}"
    )
    text = PAGE.format(camera=chosen.camera, speed=chosen.speed, command=command, rows=told)
    (chosen.out / "over_the_wire.md").write_text(text, encoding="utf-8")
    print(told)  # noqa: T201


if __name__ == "__main__":
    main()
