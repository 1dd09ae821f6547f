"""Pre-flight checks of the sensors; there may be several of a kind.

Each function returns how good it is and a sentence; what a mission could not use is named.
"""

from __future__ import annotations

from collections.abc import Sequence

from missionkit.geometry import IDENTITY
from missionkit.vehicle.failsafe_parameters import FailsafeLevel
from missionkit.vehicle.link.message_cache import Fields
from missionkit.vehicle.telemetry import (
    batteries,
    ground_sensors,
    message_readings,
    obstacle_ring,
)
from missionkit.vehicle.telemetry.batteries import Packs
from missionkit.vehicle.telemetry.message_readings import UINT16_UNKNOWN
from missionkit.vehicle.telemetry.obstacle_ring import NORTH_ALIGNED

LEAST_CHARGE, GOOD_CHARGE = 0.3, 0.6
FEW_SATELLITES, COARSE_FIX = 8, 3000  # satellites, mm
BY_FLOW = "only a mission that navigates by optical flow takes off"

Verdict = tuple[FailsafeLevel, str]


def gnss(fix: Fields | None, second: Fields | None, *, flow: bool) -> Verdict:
    """Judge the receiver whose fixes a mission would take.

    Args:
        fix: GPS_RAW_INT.
        second: GPS2_RAW.
        flow: whether there is optical flow to navigate by instead.
    """
    if fix is not None and not message_readings.fixed(fix) and second is not None:
        fix = second if message_readings.fixed(second) else fix
    without = FailsafeLevel.WARNING if flow else FailsafeLevel.BAD
    consequence = BY_FLOW if flow else "missions do not take off without one"
    if fix is None:
        return without, f"no GNSS messages: {consequence}"
    seen, accuracy_mm = int(fix["satellites_visible"]), fix.get("h_acc", 0)
    accuracy = f", {1e-3 * accuracy_mm:.1f} m" if accuracy_mm else ""
    receiver = ", of the second receiver" if fix is second else ""
    says = f"fix {fix['fix_type']}, {'?' if seen == 255 else seen} satellites{accuracy}{receiver}"
    if not message_readings.fixed(fix):
        return without, f"{says}: no 3D fix, {consequence}"
    if int(fix.get("vel", 0)) == UINT16_UNKNOWN:
        return FailsafeLevel.WARNING, f"{says}; it does not report its velocity"
    weak = seen < FEW_SATELLITES or (accuracy_mm and accuracy_mm > COARSE_FIX)
    return FailsafeLevel.WARNING if weak else FailsafeLevel.GOOD, says


def battery(packs: Packs) -> Verdict:
    """Judge the packs that carry the vehicle; name the others."""
    read, counted = batteries.battery(packs), batteries.counted(packs)
    others = [pack.says for pack in packs.values() if pack not in counted]
    rest = f"; not counted: {', '.join(others)}" if others else ""
    if read is None:
        return FailsafeLevel.WARNING, f"the charge is unknown{rest}"
    level = FailsafeLevel.GOOD if read.charge >= GOOD_CHARGE else FailsafeLevel.WARNING
    level = level if read.charge >= LEAST_CHARGE else FailsafeLevel.BAD
    several = f" ({', '.join(pack.says for pack in counted)}{rest})" if len(packs) > 1 else ""
    return level, f"{read.charge:.0%}{several}"


def obstacles(rings: Sequence[Fields]) -> Verdict:
    """Judge the recent OBSTACLE_DISTANCE messages."""
    if not rings:
        return FailsafeLevel.GOOD, "no OBSTACLE_DISTANCE arrives: a mission sees no obstacles"
    refusals = [obstacle_ring.refusal(fields, IDENTITY) for fields in rings]
    refused = next((refusal for refusal in reversed(refusals) if refusal), "")
    if refused:
        return FailsafeLevel.WARNING, f"{refused}: obstacles are not seen"
    ring = rings[-1]
    known, all_of = obstacle_ring.sectors(ring), len(ring["distances"])
    aligned = "north" if int(ring["frame"]) in NORTH_ALIGNED else "the front"
    reach = 0.01 * float(ring["max_distance"])
    return (
        FailsafeLevel.GOOD,
        f"{known} of {all_of} directions, {reach:g} m far, aligned with {aligned}",
    )


def ground(flow: Fields | None, ranges: Sequence[Fields]) -> Verdict:
    """Judge optical flow (either message) and range finders."""
    down = [fields for fields in ranges if ground_sensors.faces_down(fields)]
    aside = sorted({int(f["orientation"]) for f in ranges if not ground_sensors.faces_down(f)})
    if flow is not None and "flow_x" in flow and ground_sensors.unfilled(flow):
        return FailsafeLevel.WARNING, f"{ground_sensors.UNFILLED}: it is not used"
    findings = [
        "no optical flow" if flow is None else f"optical flow, quality {flow['quality']} of 255"
    ]
    findings += ["a range finder down" if down else "no range finder down"]
    findings += [f"those that face {aside} (MAV_SENSOR_ORIENTATION) are not used"] if aside else []
    half = (flow is None) != (not down) or bool(aside and not down)
    return FailsafeLevel.WARNING if half and flow is not None else FailsafeLevel.GOOD, ", ".join(
        findings
    )
