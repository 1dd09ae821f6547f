"""`missionkit fence`: the mission's fence and rally points, given to the autopilot itself."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.api.missions import assemble
from missionkit.api.vehicle_flight import origin_wanted
from missionkit.chart.load import load
from missionkit.chart.prose.phrases import counted
from missionkit.cli.autopilot_fence import AutopilotFence, fence_of, plan_file
from missionkit.cli.overrides import overrides
from missionkit.errors import ExitCode, UsageError, VehicleError
from missionkit.geodesy import Origin
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.command.fence_upload import (
    polygon,
    rally,
    set_fence,
    set_rally,
)
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.preflight.inspection import wait_for_messages

Point = tuple[float, float, float]
HEIGHTS = {"PX4": "GF_MAX_VER_DIST", "ArduPilot": "FENCE_ALT_MAX"}
HOME_TIMEOUT = 10.0  # s to wait for home


class FenceOptions(NamedTuple):
    """Options of the command."""

    address: str | None  # None: nothing is uploaded
    mission: Path
    settings: Sequence[str]
    plugins: Sequence[Path]
    margin: float  # m beyond the mission's own fence
    rally: Sequence[str]
    system: int | None = None  # MAVLink system id, where several vehicles share the link
    export: Path | None = None  # file to write


def fence(wanted: FenceOptions) -> ExitCode:
    """Upload, read back, and say what the autopilot has now; or write a file for QGroundControl.

    Raises:
        FileError: the mission cannot be used.
        UsageError: it has no fence, or a rally point or the address is none.
        VehicleError: no vehicle answers, it flies, or it has not accepted the fence.
    """
    mission = load(wanted.mission, assemble(wanted.plugins), overrides(wanted.settings))
    around = fence_of(mission, wanted.margin)
    points = [_point(text) for text in wanted.rally]
    if wanted.export is not None:
        wanted.export.write_text(plan_file(mission, around, points), encoding="utf-8")
        print("\n".join((f"{wanted.export}: written", *_shape(around, points))))  # noqa: T201
    if wanted.address is not None:
        origin = origin_wanted(mission)
        address = parse(wanted.address)
        vehicle = MavsdkVehicle(address, system=wanted.system, guard=None, wanted=origin)
        print("\n".join(asyncio.run(_given(vehicle, around, points))))  # noqa: T201
    return ExitCode.SUCCESS


def _point(text: str) -> Point:
    """Read NORTH,EAST,HEIGHT."""
    try:
        north, east, height = (float(part) for part in text.split(","))
    except ValueError:
        north = east = height = math.nan
    if not all(map(math.isfinite, (north, east, height))):
        raise UsageError(f"--rally {text}: must be NORTH,EAST,HEIGHT in metres, such as 10,-5,20")
    return north, east, height


async def _given(
    vehicle: MavsdkVehicle, around: AutopilotFence, points: Sequence[Point]
) -> list[str]:
    await vehicle.connect()
    try:
        home = await _home(vehicle)
        items = polygon(home, around.corners, around.holes)
        await vehicle.call(set_fence, vehicle.link, items)
        if points:
            await vehicle.call(set_rally, vehicle.link, rally(home, points))
        name = HEIGHTS[vehicle.dialect.name]
        height = await vehicle.call(vehicle.link.parameter, name)
    finally:
        await vehicle.close()
    report = _said(vehicle.address.url, home, around, points)
    return [*report, _height(name, height, around.height)]


async def _home(vehicle: MavsdkVehicle) -> Origin:
    """Wait until the vehicle on the ground has reported its home position."""
    if vehicle.state.armed:
        raise VehicleError(
            "the vehicle is armed: upload a fence only while it is disarmed on the ground"
        )
    await wait_for_messages(vehicle, ("HOME_POSITION",), HOME_TIMEOUT)
    await vehicle.observe(0.0)
    if vehicle.observer.misplaced:
        raise VehicleError(vehicle.observer.misplaced)
    if vehicle.observer.origin is None:
        raise VehicleError(
            f"the vehicle has not reported its home for {HOME_TIMEOUT:g} s: check its GNSS"
        )
    return vehicle.observer.origin


def _said(url: str, home: Origin, around: AutopilotFence, points: Sequence[Point]) -> Iterable[str]:
    yield f"{url}: the autopilot has the fence; it was read back as sent"
    yield f"  origin {home.latitude:.7f}, {home.longitude:.7f}"
    yield from _shape(around, points)


def _shape(around: AutopilotFence, points: Sequence[Point]) -> Iterable[str]:
    norths, easts = zip(*around.corners, strict=True)
    yield f"  north  {round(min(norths), 1):g} to {round(max(norths), 1):g} m"
    yield f"  east   {round(min(easts), 1):g} to {round(max(easts), 1):g} m"
    yield f"  {counted(len(around.corners), 'corner')}, {counted(len(around.holes), 'hole')}"
    yield from (f"  not in it: {what}" for what in around.left_out)
    for n, point in enumerate(points, 1):
        yield "  rally {}  {:g} m north, {:g} m east, {:g} m above home".format(n, *point)


def _height(name: str, value: float | None, wanted: float) -> str:
    """Say whether the parameter that limits the height fits; it is not touched."""
    if value is not None and 0.0 < value <= wanted:
        return f"  height {value:g} m, by {name}"
    now = "is not known" if value is None else f"is {value:g}"
    return f"  height is not limited as the mission requires: {name} {now}, set {wanted:g}"
