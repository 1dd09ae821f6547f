"""`missionkit preflight`: what a vehicle says about itself, judged; with `--set`, made safe."""

from __future__ import annotations

import asyncio
import sys
from typing import NamedTuple

from missionkit.errors import ExitCode, UsageError, VehicleError
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.preflight.inspection import inspect, parameters
from missionkit.vehicle.preflight.parameter_setting import ParameterChange, proposed, write
from missionkit.vehicle.preflight.preflight_report import PreflightReport


class PreflightOptions(NamedTuple):
    """The options of the command."""

    address: str
    system: int | None = None  # MAVLink system id, where several vehicles share the link
    as_json: bool = False
    write: bool = False  # safe parameters
    yes: bool = False  # without asking
    patience: float = 10.0  # s to wait for the vehicle


def preflight(wanted: PreflightOptions) -> ExitCode:
    """Print the pre-flight report of a vehicle; write safe parameters if that is wanted.

    Raises:
        UsageError: the address is none, or the options do not fit together.
        VehicleError: no vehicle answers, or it is armed and parameters are to be written.
    """
    if wanted.write and wanted.as_json:
        raise UsageError("--set reports its changes as text: leave out --json")
    if wanted.write and not wanted.yes and not sys.stdin.isatty():
        raise UsageError(
            "--set asks before it writes each parameter: add --yes when there is no terminal"
        )
    return asyncio.run(_looked(wanted))


async def _looked(wanted: PreflightOptions) -> ExitCode:
    vehicle = MavsdkVehicle(
        parse(wanted.address), patience=wanted.patience, system=wanted.system, guard=None
    )
    await vehicle.connect()
    try:
        report = await inspect(vehicle)
        _say(report, as_json=wanted.as_json)
        done = not wanted.write or await _made_safe(vehicle, yes=wanted.yes)
    finally:
        await vehicle.close()
    return ExitCode.SUCCESS if report.fit and done else ExitCode.ENDED_SAFELY


async def _made_safe(vehicle: MavsdkVehicle, *, yes: bool) -> bool:
    """Write what is proposed and agreed to; say whether all of it was read back."""
    if vehicle.state.armed is not False:
        raise VehicleError(
            f"{vehicle.address.url} is armed: parameters are written only while it is disarmed"
        )
    changes = proposed(vehicle.dialect, await vehicle.call(parameters, vehicle))
    if not changes:
        print("no parameter needs to change")  # noqa: T201
    done = True
    for change in changes:
        if not (yes or await asyncio.to_thread(_agreed, change)):
            print(f"{change.parameter} stays {change.was:g}")  # noqa: T201
            continue
        written = await vehicle.call(write, vehicle.link, change)
        print(written.says, flush=True)  # noqa: T201
        done = done and written.good
    return done


def _agreed(change: ParameterChange) -> bool:
    try:
        return input(f"{change.question} [y/N] ").strip().lower() in {"y", "yes"}
    except EOFError:
        return False


def _say(report: PreflightReport, *, as_json: bool) -> None:
    print(report.json() if as_json else report.text(), flush=True)  # noqa: T201
