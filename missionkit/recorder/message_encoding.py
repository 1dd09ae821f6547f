"""Records of a tick -> JSON text, one function per topic.

`at` is the time already written as JSON by `json_fragments.stamp`.
"""

from __future__ import annotations

import base64
import math

import numpy as np

from missionkit.camera_pointing import seen_mount
from missionkit.geometry import IDENTITY, Quat, Transform, Vec3, from_euler, from_matrix, norm, vec
from missionkit.messages import (
    TRACKED,
    AnySetpoint,
    AttitudeSetpoint,
    CameraModel,
    Command,
    Cycle,
    Estimate,
    Fired,
    Goal,
    PositionSetpoint,
    Record,
    Sighting,
    Target,
    Wrench,
)
from missionkit.recorder import json_fragments

WORLD_FRAME, NED_FRAME, BASE_FRAME, CAMERA_FRAME = "world", "world_ned", "base", "camera"

# Viewers draw z upwards: the root of the tree is east, north, up.
UPRIGHT = Transform(
    from_matrix(np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])),
    vec(0.0, 0.0, 0.0),
)
SEEN = json_fragments.colour(0.0, 0.9, 0.4)
CLEAR = json_fragments.colour(0.0, 0.0, 0.0, 0.0)
DARK = json_fragments.colour(0.0, 0.0, 0.0, 0.6)


def pose(at: str, position: Vec3, attitude: Quat) -> str:
    """Return a pose in world NED: (3,) m and (4,) body to world.

    Args:
        at: JSON of the time.
        position: (3,), m.
        attitude: (4,).
    """
    where = json_fragments.pose(position, attitude)
    return f'{{"timestamp":{at},"frame_id":"{NED_FRAME}","pose":{where}}}'


def goal(at: str, aim: Goal) -> str:
    """Return where the behaviour is going; heading north when the yaw does not matter."""
    attitude = IDENTITY if aim.yaw is None else from_euler(0.0, 0.0, aim.yaw)
    return pose(at, aim.position, attitude)


def body(at: str, seen: Estimate, camera: CameraModel | None = None) -> str:
    """Return the moving links of the frame tree: world NED <- base, and a gimbal's base <- camera.

    Args:
        at: JSON of the time.
        seen: the estimate.
        camera: lens and mount.
    """
    placed = Transform(seen.attitude, seen.position)
    links = [json_fragments.transform(at, NED_FRAME, BASE_FRAME, placed)]
    if camera is not None and camera.gimbal_sd is not None:
        mount = seen_mount(camera, seen)
        if mount is not None:
            links.append(json_fragments.transform(at, BASE_FRAME, CAMERA_FRAME, mount))
    return f'{{"transforms":[{",".join(links)}]}}'


def fixed_links(at: str, camera: CameraModel | None) -> str:
    """Return the links that never move: world <- world NED, base <- a fixed camera."""
    links = [json_fragments.transform(at, WORLD_FRAME, NED_FRAME, UPRIGHT)]
    if camera is not None and camera.gimbal_sd is None:
        links.append(json_fragments.transform(at, BASE_FRAME, CAMERA_FRAME, camera.mount))
    return f'{{"transforms":[{",".join(links)}]}}'


def command(at: str, sent: Command) -> str:
    """Return what was sent to the vehicle."""
    parts = [f'{{"timestamp":{at}']
    if sent.setpoint is not None:
        parts.append(_setpoint(sent.setpoint))
    if sent.action is not None:
        parts.append(f'"action":"{sent.action.value}"')
    if sent.height is not None:
        parts.append(f'"height":{float(sent.height)}')
    if sent.payload is not None:
        parts.append(f'"payload":{json_fragments.text(sent.payload)}')
    if sent.orders:
        said = ", ".join(f"{it.device} {it.number}: {it.value:g}" for it in sent.orders)
        parts.append(f'"orders":{json_fragments.text(said)}')
    if sent.gimbal is not None:
        pitch, yaw = map(math.degrees, sent.gimbal)
        parts.append(f'"gimbal_deg":{{"pitch":{pitch},"yaw":{yaw}}}')
    return ",".join(parts) + "}"


def _setpoint(sent: AnySetpoint) -> str:
    match sent:
        case PositionSetpoint(position, yaw):
            return f'"position":{json_fragments.vector(position)},"yaw":{float(yaw)}'
        case AttitudeSetpoint(attitude, thrust):
            return f'"attitude":{json_fragments.quaternion(attitude)},"thrust":{float(thrust)}'
        case Wrench(force, torque):
            exerted = json_fragments.vector(force), json_fragments.vector(torque)
            return f'"force":{exerted[0]},"torque":{exerted[1]}'
        case _:
            velocity = json_fragments.vector(sent.velocity)
            return f'"velocity":{velocity},"yaw_rate":{float(sent.yaw_rate)}'


def guards(at: str, record: Record) -> str:
    """Return every guard that was evaluated, with its answer."""
    return f'{{"timestamp":{at},"guards":{json_fragments.verdicts(record.verdicts)}}}'


def state(at: str, record: Record, since: float) -> str:
    """Return where the chart stands; `since` (s) is when the state was entered.

    Args:
        at: JSON of the time.
        record: of the tick.
        since: mission time, s.
    """
    return (
        f'{{"timestamp":{at},"state":{json_fragments.text(record.state)},"mode":"{record.mode.value}",'
        f'"since":{float(since)},"done":{json_fragments.flag(record.estimate.done)},'
        f'"note":{json_fragments.text(record.step_note)},"problems":{json_fragments.texts(record.problems)}}}'
    )


def transition(at: str, fired: Fired) -> str:
    """Return a transition with the guards that decided it and the outputs it carried out."""
    return (
        f'{{"timestamp":{at},"source":{json_fragments.text(fired.source)},"to":{json_fragments.text(fired.to)},'
        f'"reason":{json_fragments.text(fired.reason)},"verdicts":{json_fragments.verdicts(fired.verdicts)},'
        f'"outputs":{json_fragments.texts(fired.outputs)}}}'
    )


def estimate(at: str, seen: Estimate) -> str:
    """Return velocity, height, heading and the estimates of the targets."""
    own = (it for name, it in seen.targets.items() if name != TRACKED)
    targets = ",".join(map(_target, own))
    range_ = "" if seen.range is None else f',"range":{float(seen.range.distance)}'
    return (
        f'{{"timestamp":{at},"velocity":{json_fragments.vector(seen.velocity)},'
        f'"speed":{float(norm(seen.velocity))},"height":{float(-seen.position[2])},'
        f'"yaw_deg":{math.degrees(seen.yaw)},"position_sd":{float(seen.health.position_sd)},'
        f'"targets":[{targets}]{range_}}}'
    )


def _target(it: Target) -> str:
    seen_at = "" if it.seen_at is None else f',"seen_at":{float(it.seen_at)}'
    return (
        f'{{"name":{json_fragments.text(it.name)},"position":{json_fragments.vector(it.position)},'
        f'"position_sd":{float(it.position_sd)}{seen_at}}}'
    )


def status(at: str, seen: Estimate) -> str:
    """Return battery, autopilot and the health of the estimate."""
    health = seen.health
    parts = [
        f'{{"timestamp":{at},"aligned":{json_fragments.flag(health.aligned)}',
        f'"diverged":{json_fragments.flag(health.diverged)}',
        f'"position_sd":{float(health.position_sd)},"rejected":{int(health.rejected)}',
    ]
    if seen.battery is not None:
        _, charge, voltage = seen.battery
        parts.append(f'"charge":{float(charge)},"voltage":{float(voltage)}')
    if seen.status is not None:
        parts.append(
            f'"armed":{json_fragments.flag(seen.status.armed)},"in_air":{json_fragments.flag(seen.status.in_air)},'
            f'"vehicle_mode":{json_fragments.text(seen.status.mode)}'
        )
    if health.gnss_at is not None:
        parts.append(f'"gnss_at":{float(health.gnss_at)}')
    if health.vision_at is not None:
        parts.append(f'"vision_at":{float(health.vision_at)}')
    if health.mahalanobis is not None:
        parts.append(f'"mahalanobis":{float(health.mahalanobis)}')
    return ",".join(parts) + "}"


def timing(at: str, cycle: Cycle) -> str:
    """Return how long the tick before took (s)."""
    return (
        f'{{"timestamp":{at},"sense":{float(cycle.sense)},"process":{float(cycle.process)},'
        f'"control":{float(cycle.control)},"total":{float(cycle.total)},'
        f'"overruns":{cycle.overruns}}}'
    )


def log(at: str, level: int, message: str) -> str:
    """Return a line of the log; `level` is 2 for information, 3 for a warning.

    Args:
        at: JSON of the time.
        level: of `foxglove.Log`.
        message: any text; escaped here.
    """
    return (
        f'{{"timestamp":{at},"level":{level},"message":{json_fragments.text(message)},'
        '"name":"missionkit","file":"","line":0}'
    )


def image(at: str, jpeg: bytes) -> str:
    """Return one camera frame."""
    data = base64.b64encode(jpeg).decode("ascii")
    return f'{{"timestamp":{at},"frame_id":"{CAMERA_FRAME}","data":"{data}","format":"jpeg"}}'


def calibration(at: str, camera: CameraModel) -> str:
    """Return the camera's intrinsics; its distortion is Brown's with k1, k2, p1, p2, k3."""
    K = camera.matrix
    P = np.hstack([K, np.zeros((3, 1))])
    return (
        f'{{"timestamp":{at},"frame_id":"{CAMERA_FRAME}","width":{camera.width},'
        f'"height":{camera.height},"distortion_model":"plumb_bob",'
        f'"D":{camera.distortion.ravel().tolist()},"K":{K.ravel().tolist()},'
        f'"R":{np.eye(3).ravel().tolist()},"P":{P.ravel().tolist()}}}'
    )


def markers(at: str, sightings: tuple[Sighting, ...]) -> str:
    """Return outlines and names of the markers found, to be drawn over the image."""
    outlines = ",".join([_outline(at, it) for it in sightings])
    names = ",".join([_name(at, it) for it in sightings])
    return f'{{"circles":[],"points":[{outlines}],"texts":[{names}]}}'


def _outline(at: str, it: Sighting) -> str:
    corners = ",".join([f'{{"x":{x},"y":{y}}}' for x, y in it.detection.corners.tolist()])
    return (
        f'{{"timestamp":{at},"type":2,"points":[{corners}],"outline_color":{SEEN},'
        f'"outline_colors":[],"fill_color":{CLEAR},"thickness":2}}'
    )


def _name(at: str, it: Sighting) -> str:
    x, y = it.detection.corners.max(axis=0).tolist()
    label = json_fragments.text(f"{it.target} ({it.id})")
    return (
        f'{{"timestamp":{at},"position":{{"x":{x},"y":{y}}},"text":{label},"font_size":12,'
        f'"text_color":{SEEN},"background_color":{DARK}}}'
    )
