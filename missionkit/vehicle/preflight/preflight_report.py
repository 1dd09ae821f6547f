"""Before a flight: what the vehicle says about itself, judged.

Everything is read first (`Findings`), then judged by plain functions; the report is data and text.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from missionkit.vehicle.autopilot_dialect import Dialect
from missionkit.vehicle.failsafe_parameters import FailsafeLevel
from missionkit.vehicle.link.message_cache import Fields
from missionkit.vehicle.preflight import sensor_checks
from missionkit.vehicle.telemetry.batteries import NO_PACKS, Packs

_MARKS = {FailsafeLevel.GOOD: "ok  ", FailsafeLevel.WARNING: "warn", FailsafeLevel.BAD: "BAD "}
MOST_CLOCK, MOST_DATE = 0.02, 5.0  # share, s
MOST_NORTH = 2.5  # deg


class Findings(NamedTuple):
    """Values read; None or missing if the vehicle has not sent them."""

    armed: bool | None
    in_air: bool | None
    mode: str | None
    armable: bool | None
    sensors: Mapping[str, bool | None]
    home: Fields | None
    local: Fields | None
    fix: Fields | None
    parameters: Mapping[str, float | None]
    date_gap: float | None  # s, vehicle's date ahead of the computer's
    clock_rate: float | None  # seconds of the vehicle in one of the wall
    pace: float = 1.0
    declination: float | None = None  # deg, of the field from the autopilot's north, eastwards
    contested: bool = False  # two vehicles answer with one system id
    second_fix: Fields | None = None  # GPS2_RAW
    packs: Packs = NO_PACKS
    rings: Sequence[Fields] = ()  # OBSTACLE_DISTANCE, the last ones
    flow: Fields | None = None  # OPTICAL_FLOW_RAD or OPTICAL_FLOW
    ranges: Sequence[Fields] = ()  # DISTANCE_SENSOR, the last ones
    misplaced: str = ""  # why the mission cannot be flown from this home
    to_be_set: Sequence[str] = ()  # parameters without which its landing is not a precise one


class Check(NamedTuple):
    """One line of the report."""

    what: str
    level: FailsafeLevel
    says: str


class PreflightReport(NamedTuple):
    """Results of the pre-flight checks."""

    vehicle: str
    checks: tuple[Check, ...]

    @property
    def level(self) -> FailsafeLevel:
        """The worst of all."""
        return max((check.level for check in self.checks), default=FailsafeLevel.GOOD)

    @property
    def fit(self) -> bool:
        """Whether nothing speaks against flying; warnings are for a person to weigh."""
        return self.level is not FailsafeLevel.BAD

    def text(self) -> str:
        """Return the report for people."""
        width = max(len(check.what) for check in self.checks)
        lines = [f"{_MARKS[c.level]} {c.what:{width}}  {c.says}" for c in self.checks]
        verdict = {
            FailsafeLevel.GOOD: "ready to fly",
            FailsafeLevel.WARNING: "can fly, but read the warnings",
            FailsafeLevel.BAD: "not fit to fly",
        }[self.level]
        return "\n".join([f"{self.vehicle}: {verdict}", *lines])

    def json(self) -> str:
        """Return the report for programs."""
        checks = [
            {"what": c.what, "level": c.level.name.lower(), "says": c.says} for c in self.checks
        ]
        whole = {"vehicle": self.vehicle, "level": self.level.name.lower(), "checks": checks}
        return json.dumps(whole, indent=2)


def judged(vehicle: str, dialect: Dialect, found: Findings) -> PreflightReport:
    """Return the report on what was found.

    Args:
        vehicle: name for the head of the report.
        dialect: which parameters and modes to look for.
        found: `None` in it where nothing was heard, which counts against flying.
    """
    by_flow = found.flow is not None
    checks = (
        *_system(found),
        _state(found),
        _health(found),
        _home(found),
        *_origin(found),
        _estimator(found),
        Check("gnss", *sensor_checks.gnss(found.fix, found.second_fix, flow=by_flow)),
        Check("battery", *sensor_checks.battery(found.packs)),
        Check("obstacles", *sensor_checks.obstacles(found.rings)),
        Check("ground", *sensor_checks.ground(found.flow, found.ranges)),
        *_parameters(dialect, found),
        *_thresholds(dialect, found),
        *_precise_landing(found),
        *_north(found),
        *_clock(found),
    )
    return PreflightReport(vehicle, checks)


def _system(found: Findings) -> list[Check]:
    if not found.contested:
        return []
    says = "two vehicles use the same system id: give each its own"
    return [Check("system", FailsafeLevel.BAD, says)]


def _state(found: Findings) -> Check:
    if found.armed is None:
        return Check("state", FailsafeLevel.BAD, "no heartbeat")
    says = f"{'armed' if found.armed else 'disarmed'}, mode {found.mode}"
    if found.in_air:
        return Check("state", FailsafeLevel.WARNING, f"already in the air, {says}")
    return Check(
        "state",
        FailsafeLevel.WARNING if found.armed else FailsafeLevel.GOOD,
        f"on the ground, {says}",
    )


def _health(found: Findings) -> Check:
    ill = [name for name, good in found.sensors.items() if good is False]
    missing = [name for name, good in found.sensors.items() if good is None]
    if ill == ["GNSS"] and found.flow is not None:
        return Check("health", FailsafeLevel.WARNING, "unhealthy: GNSS, but there is optical flow")
    if ill:
        return Check("health", FailsafeLevel.BAD, f"unhealthy: {', '.join(ill)}")
    if found.armable is False:
        return Check(
            "health", FailsafeLevel.BAD, "its own arming checks fail; see its status texts"
        )
    if found.armable is None:
        return Check("health", FailsafeLevel.WARNING, "it does not say whether it can be armed")
    if missing:
        return Check("health", FailsafeLevel.WARNING, f"not reported: {', '.join(missing)}")
    return Check("health", FailsafeLevel.GOOD, "sensors healthy, arming checks pass")


def _home(found: Findings) -> Check:
    home = found.home
    if home is None and found.flow is not None:
        return Check("home", FailsafeLevel.WARNING, "no home position: the autopilot cannot return")
    if home is None:
        return Check("home", FailsafeLevel.BAD, "no home position: wait for a fix")
    place = f"{1e-7 * home['latitude']:.6f}, {1e-7 * home['longitude']:.6f}"
    return Check("home", FailsafeLevel.GOOD, f"{place}, {1e-3 * home['altitude']:.0f} m")


def _origin(found: Findings) -> list[Check]:
    return [Check("origin", FailsafeLevel.BAD, found.misplaced)] if found.misplaced else []


def _estimator(found: Findings) -> Check:
    local = found.local
    if local is None:
        return Check("estimator", FailsafeLevel.BAD, "no local position")
    values = [local[name] for name in ("x", "y", "z", "vx", "vy", "vz")]
    if any(value is None or not math.isfinite(value) for value in values):
        return Check("estimator", FailsafeLevel.BAD, "the local position is not a number")
    speed = math.sqrt(sum(float(v) ** 2 for v in values[3:]))
    if speed > 0.5 and not found.in_air:
        return Check("estimator", FailsafeLevel.BAD, f"it reports {speed:.1f} m/s on the ground")
    return Check("estimator", FailsafeLevel.GOOD, f"local position, {speed:.2f} m/s at rest")


def _parameters(dialect: Dialect, found: Findings) -> list[Check]:
    checks = []
    for failsafe in dialect.failsafes:
        value = found.parameters.get(failsafe.parameter)
        if value is None:
            says = "could not be read: check it by hand"
            checks.append(Check(failsafe.parameter, FailsafeLevel.WARNING, says))
            continue
        level, why = failsafe.judge(value)
        checks.append(Check(failsafe.parameter, level, f"{value:g}{': ' if why else ''}{why}"))
    return checks


def _thresholds(dialect: Dialect, found: Findings) -> list[Check]:
    return [Check(it.parameters[0], *it.judge(found.parameters)) for it in dialect.thresholds]


def _precise_landing(found: Findings) -> list[Check]:
    """Look for what an autopilot would otherwise leave out without a word."""
    checks = []
    for name in found.to_be_set:
        value = found.parameters.get(name)
        says = "on" if value else "could not be read: check it by hand"
        level = FailsafeLevel.GOOD if value else FailsafeLevel.WARNING
        if value == 0.0:
            level = FailsafeLevel.BAD
            says = (
                "0, so it would land by satellites: the mission lands 'by: autopilot'; set it to 1"
            )
        checks.append(Check(name, level, says))
    return checks


def _north(found: Findings) -> list[Check]:
    """Tell what missionkit's own filter has to know about the place."""
    if found.declination is None:
        return []
    says = f"the field points {found.declination:+.1f} deg from the autopilot's north"
    if abs(found.declination) <= MOST_NORTH:
        return [Check("north", FailsafeLevel.GOOD, says)]
    remedy = f"navigation: {{..., declination_deg: {found.declination:.0f}}} in the mission"
    return [Check("north", FailsafeLevel.WARNING, f"{says}; set {remedy}")]


def _clock(found: Findings) -> list[Check]:
    checks = []
    if found.clock_rate is not None:
        off = found.clock_rate / found.pace - 1.0
        level = FailsafeLevel.GOOD if abs(off) <= MOST_CLOCK else FailsafeLevel.WARNING
        checks.append(Check("clock", level, f"runs at {found.clock_rate / found.pace:.3f} of ours"))
    if found.date_gap is not None:
        level = FailsafeLevel.GOOD if abs(found.date_gap) <= MOST_DATE else FailsafeLevel.WARNING
        checks.append(Check("date", level, f"{found.date_gap:+.1f} s from ours"))
    return checks
