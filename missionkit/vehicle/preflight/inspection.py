"""Reading what the pre-flight report judges."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Iterable, Mapping

import numpy as np

from missionkit.errors import NotFitError
from missionkit.geometry import rotate
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.failsafe_parameters import FailsafeLevel
from missionkit.vehicle.link.clocks import unix
from missionkit.vehicle.link.message_cache import Cache, Fields, Message
from missionkit.vehicle.link.message_rates import boot_time
from missionkit.vehicle.preflight.preflight_report import Findings, PreflightReport, judged
from missionkit.vehicle.telemetry import batteries, message_readings
from missionkit.vehicle.telemetry.autopilot_state import SENSOR_BITS
from missionkit.vehicle.telemetry.home_position import home_message

NEEDED = ("SYS_STATUS", "HOME_POSITION", "LOCAL_POSITION_NED", "GPS_RAW_INT", "BATTERY_STATUS")
LOOK_INTERVAL = 0.1  # s between two looks at what has come
PASSING = frozenset(("state", "health", "home", "estimator", "gnss"))  # checks that may yet pass
FIT = 60.0  # s (of the vehicle) in which it may become fit to fly
WATCH_TIME = 1.5  # s (of the vehicle) over which it is watched, and its clock compared with ours
TIMES_TENDED = 30  # times that it is tended to meanwhile


async def inspect(
    vehicle: MavsdkVehicle, patience: float = 5.0, pace: float = 1.0
) -> PreflightReport:
    """Return the pre-flight report of a vehicle that is connected.

    Args:
        vehicle: to be looked at; nothing is commanded but streams.
        patience: s to wait for messages that have not come yet.
        pace: seconds of the vehicle in one of the wall.
    """
    await wait_for_messages(vehicle, NEEDED, patience)
    first = vehicle.cache.latest("LOCAL_POSITION_NED")
    values = await vehicle.call(parameters, vehicle)
    await _watched(vehicle, WATCH_TIME / max(1.0, pace))
    findings = _found(vehicle, first, values, pace)
    return judged(f"{vehicle.dialect.name} at {vehicle.address.url}", vehicle.dialect, findings)


async def become_fit(
    vehicle: MavsdkVehicle,
    give_up: Callable[[], bool],
    pace: float = 1.0,
    patience: float = FIT,
) -> None:
    """Wait until the pre-flight report of a connected vehicle has nothing against flying.

    One that flies already, or is armed, is left to the mission. Autopilots say for half a minute
    after their start that they are not ready.

    Args:
        vehicle: to be looked at; nothing is commanded but streams.
        give_up: says whether not to wait any longer.
        pace: seconds of the vehicle in one of the wall.
        patience: s (of the vehicle) to wait.

    Raises:
        NotFitError: something still speaks against it; everything that does is named.
    """
    end = vehicle.cache.wall() + patience / pace
    while True:
        report = await inspect(vehicle, pace=pace)
        if report.fit or vehicle.state.armed:
            return
        bad = [check for check in report.checks if check.level is FailsafeLevel.BAD]
        lasting = any(check.what not in PASSING for check in bad)
        if lasting or give_up() or vehicle.cache.wall() >= end:
            break
    lines = "\n".join(f"  - {it.what}: {it.says}" for it in bad)
    raise NotFitError(
        f"{report.vehicle}: not fit to fly, so it was not armed:\n{lines}\n--anyway overrides this"
    )


async def wait_for_messages(vehicle: MavsdkVehicle, names: Iterable[str], patience: float) -> bool:
    """Ask for streams until a message of each name has come; say whether that was in time (s).

    Args:
        vehicle: connected.
        names: of MAVLink messages.
        patience: s, real time.
    """
    for _ in range(round(patience / LOOK_INTERVAL)):
        vehicle.maintain()
        if all(_is_told(vehicle.cache, name) for name in names):
            return True
        await asyncio.sleep(LOOK_INTERVAL)
    return False


async def _watched(vehicle: MavsdkVehicle, span: float) -> None:
    """Listen for some time (s, wall), in which two vehicles with one system id show."""
    for _ in range(TIMES_TENDED):
        vehicle.maintain()
        await asyncio.sleep(span / TIMES_TENDED)


def _is_told(cache: Cache, name: str) -> bool:
    if name == "HOME_POSITION":
        return home_message(cache) is not None
    return cache.latest(name) is not None


def parameters(vehicle: MavsdkVehicle) -> dict[str, float | None]:
    """Read what the failsafes depend on; None: the autopilot did not answer."""
    dialect = vehicle.dialect
    names = [it.parameter for it in dialect.failsafes]
    names += [name for it in dialect.thresholds for name in it.parameters]
    names += vehicle.wants_set
    return {name: vehicle.link.parameter(name) for name in names}


def _found(
    vehicle: MavsdkVehicle,
    first: Message | None,
    values: Mapping[str, float | None],
    pace: float,
) -> Findings:
    state = vehicle.state
    return Findings(
        armed=state.armed,
        in_air=state.in_air,
        mode=state.mode,
        armable=state.armable,
        sensors={name: state.sensor(name) for name in SENSOR_BITS},
        home=None if (home := home_message(vehicle.cache)) is None else home.fields,
        local=_fields(vehicle, "LOCAL_POSITION_NED"),
        fix=_fields(vehicle, "GPS_RAW_INT"),
        parameters=values,
        date_gap=_date_gap(vehicle),
        clock_rate=_rate(first, vehicle.cache.latest("LOCAL_POSITION_NED")),
        pace=pace,
        declination=_declination(vehicle),
        contested=vehicle.contested,
        second_fix=_fields(vehicle, "GPS2_RAW"),
        packs=batteries.all_of((fields, 0.0) for fields in _drained(vehicle, "BATTERY_STATUS")),
        rings=_drained(vehicle, "OBSTACLE_DISTANCE"),
        flow=_fields(vehicle, "OPTICAL_FLOW_RAD") or _fields(vehicle, "OPTICAL_FLOW"),
        ranges=_drained(vehicle, "DISTANCE_SENSOR"),
        misplaced=vehicle.observer.misplaced,
        to_be_set=vehicle.wants_set,
    )


def _declination(vehicle: MavsdkVehicle) -> float | None:
    """Return where the measured field points (deg) in the autopilot's frame, east of its north."""
    turned = vehicle.cache.latest("ATTITUDE_QUATERNION")
    attitude = None if turned is None else message_readings.turned(turned.fields)
    samples = [
        message_readings.magnetometer(it.fields, 0.0) for it in vehicle.cache.drain("HIGHRES_IMU")
    ]
    fields = [it.field for it in samples if it is not None]
    if attitude is None or not fields:
        return None
    north, east, _ = rotate(attitude, np.mean(fields, axis=0)).tolist()
    return math.degrees(math.atan2(east, north))


def _drained(vehicle: MavsdkVehicle, name: str) -> list[Fields]:
    """Return the messages since the last call, at least the newest."""
    new = [message.fields for message in vehicle.cache.drain(name)]
    last = vehicle.cache.latest(name)
    return new or ([] if last is None else [last.fields])


def _fields(vehicle: MavsdkVehicle, name: str) -> Fields | None:
    message = vehicle.cache.latest(name)
    return None if message is None else message.fields


def _date_gap(vehicle: MavsdkVehicle) -> float | None:
    system_time = vehicle.cache.latest("SYSTEM_TIME")
    if system_time is None or not system_time["time_unix_usec"]:
        return None
    age = vehicle.cache.wall() - system_time.arrived
    return 1e-6 * float(system_time["time_unix_usec"]) - (unix() - age)


def _rate(first: Message | None, last: Message | None) -> float | None:
    if first is None or last is None or last.arrived - first.arrived < 0.1 * WATCH_TIME:
        return None
    begun, ended = boot_time(first), boot_time(last)
    if begun is None or ended is None:
        return None
    return (ended - begun) / (last.arrived - first.arrived)
