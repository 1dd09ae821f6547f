"""Faults of a rehearsal, each with a name and a start time.

    NAME[=VALUE][@WHEN][+DURATION]      WHEN: seconds, or STATE[:DELAY]

`gnss_lost@20+10` from 20 s to 30 s; `marker_hidden@visual:1.5+6` for 6 s, beginning 1.5 s after the
mission first enters the state visual; `gnss_jump=8@gps` for good, from the first entry to gps.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import NamedTuple

from missionkit.errors import UsageError, nearest
from missionkit.messages import Cycle


class Kind(NamedTuple):
    """One kind of fault: its default value, unit, and what it does."""

    value: float | None
    unit: str
    effect: str
    least: float = -1e6
    most: float = 1e6
    whole: bool = False  # a number of something


FAULT_KINDS: Mapping[str, Kind] = {
    "baro_stuck": Kind(None, "", "the barometer repeats the last height, with new times"),
    "camera_frozen": Kind(None, "", "the camera repeats its last frame, with its old time"),
    "camera_off": Kind(None, "", "no frames"),
    "camera_delayed": Kind(0.5, "s", "frames arrive later by VALUE", least=0.0, most=60.0),
    "camera_flipped": Kind(None, "", "images arrive upside down"),
    "gimbal_lost": Kind(None, "", "the gimbal does not say how it is turned"),
    "gnss_lost": Kind(None, "", "no fixes, and the autopilot's own velocity drifts"),
    "gnss_jump": Kind(10.0, "m", "fixes are offset to the north by VALUE"),
    "gnss_drift": Kind(0.5, "m/s", "fixes drift to the north at VALUE"),
    "gnss_toggling": Kind(
        4.0, "s", "fixes are lost, as with gnss_lost, in every other half of VALUE", least=0.02
    ),
    "imu_biased": Kind(2.0, "m/s²", "the accelerometer is biased by VALUE forwards", -100.0, 100.0),
    "marker_hidden": Kind(
        None, "id", "the marker VALUE (default: every marker) is covered", least=0.0
    ),
    "link_lost": Kind(None, "", "no heartbeats and battery readings; commands still arrive"),
    "external_pose_lost": Kind(None, "", "no external poses"),
    "range_lost": Kind(None, "", "the range finder is silent"),
    "traffic_lost": Kind(None, "", "it neither hears the fleet's other vehicles nor is heard"),
    "battery_sag": Kind(0.3, "1", "the charge drops by VALUE", least=0.0, most=1.0),
    "cpu_slow": Kind(0.08, "s", "guards see every tick take VALUE", least=0.0, most=60.0),
    "velocity_bias": Kind(
        0.25,
        "m/s",
        "the autopilot's velocity has an error of VALUE, turning once a minute",
        least=0.0,
    ),
    "control_slow": Kind(
        0.1, "s", "the autopilot's velocity loop runs once every VALUE", least=0.0, most=1.0
    ),
    "wind_gust": Kind(
        6.0, "m/s", "VALUE is added along the mean wind (north without one)", -100.0, 100.0
    ),
}

FREE_FLYER_KINDS: Mapping[str, Kind] = {
    "uwb_outliers": Kind(0.1, "1", "a share VALUE of the ranges came by a detour", 0.0, 1.0),
    "uwb_lost": Kind(None, "", "no ranges to anchors"),
    "camera_off": Kind(None, "", "no features"),
    "camera_frozen": Kind(None, "", "the camera repeats the last features, with their old time"),
    "nozzle_stuck": Kind(1.0, "nozzle", "the nozzle VALUE stays shut", 1.0, 10.0, whole=True),
    "nozzle_weak": Kind(0.5, "1", "every nozzle gives a share VALUE of its thrust", 0.0, 1.0),
    "gyro_biased": Kind(0.01, "rad/s", "rates about the body's x are off by VALUE", -10.0, 10.0),
    "link_lost": FAULT_KINDS["link_lost"],
    "battery_sag": FAULT_KINDS["battery_sag"],
    "cpu_slow": FAULT_KINDS["cpu_slow"],
}
"""Faults of a simulated free flyer; those of a multicopter are `FAULT_KINDS`."""

ALL_KINDS: Mapping[str, Kind] = {**FREE_FLYER_KINDS, **FAULT_KINDS}

GRAMMAR = re.compile(
    r"(?P<name>[a-z_]+)(=(?P<value>[^@+]+))?"
    r"(@((?P<start>\d+(\.\d+)?)|(?P<state>[A-Za-z_][\w.-]*)(:(?P<delay>\d+(\.\d+)?))?))?"
    r"(\+(?P<duration>\d+(\.\d+)?))?"
)
LATEST_START = 1e6  # s
LOAD_BUDGET = 0.05  # s, of one tick
FAULT_FORM = "NAME[=VALUE][@WHEN][+DURATION], WHEN in seconds or STATE[:DELAY]"


class Fault(NamedTuple):
    """One fault and its window in time."""

    name: str
    value: float | None = None
    start: float = 0.0  # s; after entering `state` if that is given
    state: str | None = None
    duration: float = math.inf  # s

    def since(self, now: float, entered: Mapping[str, float]) -> float | None:
        """Return for how long (s) the fault has been active at `now`, `None` when it is not.

        Args:
            now: s.
            entered: when each state was first entered (s).
        """
        begin = 0.0 if self.state is None else entered.get(self.state, math.inf)
        age = now - begin - self.start
        return age if 0.0 <= age < self.duration else None


def parse_fault(text: str) -> Fault:
    """Read one fault.

    Raises:
        UsageError: unknown name, or not of the form above.
    """
    name = name_in(text)
    if name not in ALL_KINDS:
        raise UsageError(f"unknown fault {name!r}: {nearest(name, ALL_KINDS)}")
    return fault_in(text, _value)


def refuse_foreign(faults: Iterable[Fault], kinds: Mapping[str, Kind], vehicle: str) -> None:
    """Refuse faults that a vehicle does not have.

    Args:
        faults: what is to go wrong.
        kinds: the vehicle's.
        vehicle: what messages call it, with its article.

    Raises:
        UsageError: one of them is another vehicle's.
    """
    for fault in faults:
        if fault.name not in kinds:
            raise UsageError(f"{vehicle} has no fault {fault.name!r}: {nearest(fault.name, kinds)}")


def name_in(text: str) -> str:
    """Return the name that a fault as written begins with."""
    return re.split("[=@+]", text, maxsplit=1)[0]


def fault_in(text: str, value: Callable[[str, str | None], float | None]) -> Fault:
    """Read a fault whose name is known; `value` reads what stands behind "=".

    Raises:
        UsageError: not of the form above.
    """
    match = GRAMMAR.fullmatch(text)
    if match is None:
        raise UsageError(f"cannot read the fault {text!r}; the form is {FAULT_FORM}")
    name, part = name_in(text), match.groupdict()
    times = [float(part[key] or 0.0) for key in ("start", "delay", "duration")]
    if max(times) > LATEST_START:
        raise UsageError(f"fault {text[:60]!r}: times go up to {LATEST_START:g} s")
    return Fault(
        name,
        value(name, part["value"]),
        float(part["start"] or part["delay"] or 0.0),
        part["state"],
        math.inf if part["duration"] is None else float(part["duration"]),
    )


def _value(name: str, text: str | None) -> float | None:
    kind = ALL_KINDS[name]
    if text is None or (name == "marker_hidden" and text == "all"):
        return kind.value
    if not kind.unit:
        raise UsageError(f"fault {name} takes no value, got {text!r}")
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UsageError(f"fault {name} needs a number ({kind.unit}), got {text!r}")
    if not kind.least <= value <= kind.most:
        allowed = f"{kind.least:g} to {kind.most:g}"
        raise UsageError(f"fault {name} takes {allowed}, got {text}")
    if kind.whole and value != int(value):
        raise UsageError(f"fault {name} takes a whole number, got {text}")
    return value


class InjectedFaults(NamedTuple):
    """The faults of one run and when the states they wait for were first entered."""

    faults: tuple[Fault, ...]
    entered: dict[str, float]

    def since(self, name: str, now: float) -> tuple[float, float] | None:
        """Return (value, age in s) of the first active fault of that name, or `None`."""
        for fault in self.faults:
            age = fault.since(now, self.entered) if fault.name == name else None
            if age is not None:
                return fault.value or 0.0, age
        return None

    def load(self, now: float, before: Cycle) -> Cycle:
        """Return the timing that guards see at `now`: nothing of the machine that simulates.

        Args:
            now: s.
            before: of the previous tick.
        """
        slow = self.since("cpu_slow", now)
        took = 0.0 if slow is None else slow[0]
        if not took and not before.overruns:
            return before
        return Cycle(sense=took, overruns=before.overruns + (took > LOAD_BUDGET))

    def values(self, name: str, now: float) -> Iterator[float]:
        """Yield the value of every active fault of that name."""
        for fault in self.faults:
            if fault.name == name and fault.since(now, self.entered) is not None:
                yield fault.value or 0.0

    def active(self, name: str, now: float) -> bool:
        """Tell whether a fault of that name is active."""
        return self.since(name, now) is not None

    def without_fixes(self, now: float) -> float | None:
        """Return for how long (s) there have been no satellites, `None` when there are."""
        lost, toggling = self.since("gnss_lost", now), self.since("gnss_toggling", now)
        if lost is not None:
            return lost[1]
        if toggling is None or toggling[1] % toggling[0] >= 0.5 * toggling[0]:
            return None
        return toggling[1] % toggling[0]

    def hidden(self, now: float, ids: frozenset[int]) -> frozenset[int]:
        """Return which of the markers `ids` are covered at `now`."""
        covered: frozenset[int] = frozenset()
        for fault in self.faults:
            if fault.name == "marker_hidden" and fault.since(now, self.entered) is not None:
                covered |= ids if fault.value is None else ids & {int(fault.value)}
        return covered
