"""The known map over MAVLink without satellites, judged by ground truth.

`python -m studies.known_map_over_the_wire`
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np

from missionkit.api.vehicle_flight import fly_vehicle, vehicle_of
from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.prepared_mission import prepare
from missionkit.messages import Observation, Record
from studies.markdown import table
from studies.over_the_wire import Autopilot, free_port, sitl
from studies.statistics import wilson

MISSION = Path("missions/known_map.yaml")
STATE, LAST = "path", "arrived"
BLIND = ("--fault", "gnss_lost")
BY_FLOW = {"px4": "EKF2_OF_CTRL=1", "ardupilot": "EK3_SRC1_VELXY=5"}
EVERY = 20  # ticks between two looks at the truth
CLEAR = 19  # column of the track: m to the nearest obstacle
PAGE = """# Study: the known map over MAVLink, without satellites

`missionkit sitl` in a process of its own with `--fault gnss_lost` from the start, its estimator on
optical flow (`--parameter EKF2_OF_CTRL=1`, `EK3_SRC1_VELXY=5`), flown through MAVSDK from
OPTICAL_FLOW_RAD (PX4) or OPTICAL_FLOW (ArduPilot) and DISTANCE_SENSOR, {speed:g} times real time.
Success: the goal's state was reached, it landed unhurt, and no wall came nearer than the 0.5 m that
the mission plans with. Judged by the truth of the simulated autopilot; most in brackets.

    {command}

{rows}

## Deviations

{deviations}

## Assumptions

The air is calm and the room is that of [known_map.md](known_map.md). Real time, faster than the
clock: a busy machine delays messages and the simulated vehicle alike, and is part of the result.
"""


class Flown(NamedTuple):
    """One flight."""

    dialect: str
    seed: int
    end: str
    arrived: bool
    unhurt: bool
    clearance: float  # m, least on the path
    missed: float  # m, level, from the goal after landing
    drift: float  # m, level, estimate less truth, most on the path

    @property
    def succeeded(self) -> bool:
        """Whether it kept what the mission promises."""
        return self.arrived and self.unhurt and self.clearance >= 0.5


class Watch:
    """Records the states entered, the span of the path, and the drift of the estimate."""

    def __init__(self, autopilot: Autopilot) -> None:
        self.states: set[str] = set()
        self.span: tuple[float, float] | None = None  # s, simulated, on the path
        self.drift = 0.0
        self._autopilot = autopilot
        self._count = 0

    def __call__(self, record: Record, _: Observation) -> None:
        """Take in one tick."""
        new = record.state not in self.states
        self.states.add(record.state)
        self._count += 1
        if record.state != STATE or (self._count % EVERY and not new):
            return
        now, truth = self._autopilot.ask(time=True)["time"], self._autopilot.ask(truth=True)
        self.span = (now if self.span is None else self.span[0], now)
        off = record.estimate.position[:2] - np.array(truth["position"][:2])
        self.drift = max(self.drift, float(np.hypot(*off)))


def flown(dialect: str, seed: int, speed: float) -> Flown:
    """Fly the mission once."""
    mission, port = load(MISSION, builtin()), free_port()
    plan = prepare(mission, builtin())
    more = (*BLIND, "--parameter", BY_FLOW[dialect])
    with sitl(f"missions/{mission.world}", dialect, port, speed, seed, more) as autopilot:
        watch = Watch(autopilot)
        vehicle = vehicle_of(f"udpin://127.0.0.1:{port}", mission, speed=speed)
        limit = mission.settings.time_limit
        end = fly_vehicle(plan, vehicle, (watch,), speed=speed, time_limit=limit).end
        truth = autopilot.ask(truth=True)
        rows = np.array(autopilot.ask(track=True, since=0.0)["rows"], dtype=np.float64)
    begun, ended = watch.span or (0.0, 0.0)
    path = rows[(rows[:, 0] >= begun) & (rows[:, 0] <= ended)]
    away = np.array(truth["position"][:2]) - mission.targets["goal"].position[:2]
    return Flown(
        dialect,
        seed,
        str(end),
        arrived=LAST in watch.states,
        unhurt=bool(truth["on_ground"] and not truth["crashed"] and not truth["armed"]),
        clearance=float(path[:, CLEAR].min()),
        missed=float(np.hypot(*away)),
        drift=watch.drift,
    )


def row(flights: Sequence[Flown]) -> tuple[str, ...]:
    """Return the results of one dialect as a row of the table."""
    good = sum(flight.succeeded for flight in flights)
    low, high = wilson(good, len(flights))
    clearances = [flight.clearance for flight in flights]
    missed, drift = [f.missed for f in flights], [f.drift for f in flights]
    return (
        flights[0].dialect,
        f"{good} of {len(flights)}",
        f"{100.0 * low:.0f} to {100.0 * high:.0f} %",
        f"{median(clearances):.2f} ({min(clearances):.2f})",
        f"{median(missed):.2f} ({max(missed):.2f})",
        f"{median(drift):.2f} ({max(drift):.2f})",
    )


def described(flight: Flown) -> str:
    """Return a line about a flight that did not succeed."""
    return (
        f"- {flight.dialect}, seed {flight.seed}: goal {'' if flight.arrived else 'not '}reached, "
        f"{'landed unhurt' if flight.unhurt else 'hurt or not landed'}, least clearance "
        f"{flight.clearance:.2f} m, {flight.missed:.1f} m from the goal, drift {flight.drift:.2f} m"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly the mission in both dialects, and write up the results."""
    parser = argparse.ArgumentParser(prog="python -m studies.known_map_over_the_wire")
    parser.add_argument("--flights", type=int, default=20, help="in each dialect")
    parser.add_argument("--first", type=int, default=1, help="seed")
    parser.add_argument("--speed", type=float, default=3.0, help="times real time")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    rows, missed = [], []
    for dialect in BY_FLOW:
        flights: list[Flown] = []
        for seed in range(chosen.first, chosen.first + chosen.flights):
            flights.append(flown(dialect, seed, chosen.speed))
            print(flights[-1], flush=True)  # noqa: T201
        rows.append(row(flights))
        missed += [described(flight) for flight in flights if not flight.succeeded]
    header = ("dialect", "success", "95 %", "least clearance, m", "missed by, m", "drift, m")
    command = (
        f"python -m studies.known_map_over_the_wire --flights {chosen.flights} "
        f"--first {chosen.first} --speed {chosen.speed:g}"
    )
    deviations = "\n".join(missed) or "None."
    text = PAGE.format(
        speed=chosen.speed, command=command, rows=table(header, rows), deviations=deviations
    )
    chosen.out.mkdir(parents=True, exist_ok=True)
    (chosen.out / "known_map_over_the_wire.md").write_text(text, encoding="utf-8")
    print(table(header, rows))  # noqa: T201


if __name__ == "__main__":
    main()
