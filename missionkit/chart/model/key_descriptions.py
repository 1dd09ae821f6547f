"""Descriptions that editors show for keys whose fields have none of their own.

By definition of the JSON Schema and key, or by key alone where it means the same everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_GAINS = "gains of the controller in states of this mode"

DESCRIPTIONS: Mapping[str, str] = {
    "Mission.mission": "name of the mission",
    "Mission.summary": "one-line description",
    "Mission.vehicle": "what flies",
    "Mission.navigation": "the filter that says where the vehicle is",
    "Mission.camera": "the camera, real or simulated",
    "Mission.map": "what is known about the ground before the flight",
    "Mission.targets": "places by name; `home` is where the vehicle armed",
    "Mission.perception": "what is looked for in camera frames, an entry for each detector",
    "Mission.tracking": "how moving targets are tracked: `tracked` and `robot_1` name them",
    "Mission.avoid": "how obstacles are avoided",
    "Mission.control": "gains and limits of the controller",
    "Mission.failsafes": "checked first in every flying state; the first that holds wins",
    "Mission.initial": "the state to begin in",
    "Mission.states": "what the vehicle does, and when it changes, by name",
    "Mission.settings": "how the mission is flown",
    "Camera.use": "where frames come from: rendered, corners, device or none",
    "Camera.source": "number, file or URL of a device",
    "Camera.focal": "focal length (px), the same both ways",
    "Camera.focal_x": "focal length along a row (px)",
    "Camera.focal_y": "focal length along a column (px)",
    "Camera.centre": "principal point, column and row (px)",
    "Camera.matrix": "camera matrix (3 x 3, px), instead of focal length and centre",
    "Camera.distortion": "k1, k2, p1, p2, k3 as in OpenCV",
    "Camera.mount": "where the camera sits on the body, and how it is turned",
    "Mount.position": "forward, right, down of the body's centre (m)",
    "FeaturedTarget.position": "of its centre, in the mother-ship's frame (m)",
    "FeaturedTarget.attitude_deg": "of its axes: about x, then the new y, then the new z",
    "FeaturedTarget.features": "places of its feature points by their names, in its own axes (m)",
    "controllers.velocity_pid.gps": _GAINS,
    "controllers.velocity_pid.visual": _GAINS,
    "controllers.velocity_pid.trajectory": _GAINS,
    "controllers.velocity_pid.alpha_ff": "share of the reference velocity fed forward, 0 to 1",
    "controllers.velocity_pid.alpha": "smoothing of the command, 0 to 1: the share of the newest",
    "controllers.velocity_pid.yaw": "how the heading is chosen",
    "controllers.velocity_pid.limits": "speeds and accelerations that bind any behaviour",
    "Gains.kp": "of the error, level and vertical (1/s)",
    "Gains.ki": "of its integral, level and vertical (1/s²)",
    "Gains.kd": "of its derivative, level and vertical",
    "YawLaw.band": "share by which `far` and `near` grow on the way out",
    "YawLaw.gain": "rad/s for each rad of heading error",
    "Failsafe.name": "shown where it is taken",
    "Failsafe.when": "guard that must hold",
    "Failsafe.to": "state to go to",
    "Transition.name": "shown where it is taken",
    "Invariant.holds": "guard that must hold while the state is active",
    "Start.to": "state to begin in, one for each region",
    "State.summary": "one-line description",
    "State.behavior": "what the vehicle does in this state",
    "State.transitions": "ways out, tried in order",
    "State.entry": "actions on entry",
    "State.exit": "actions on leaving",
    "State.invariant": "what must hold in this state besides what its kind demands",
    "KnownMap.east": "extent to the east (m)",
    "KnownMap.weights": "areas in which a metre costs more",
    "Weight.polygon": "corners, north and east (m)",
    "Success.standoff": "out of the marker, to its right, up (m)",
    "TargetPlace.position": "north, east, down of the take-off point (m)",
    "Variable.initial": "value at the beginning",
    "World.ground": "what the ground looks like",
    "World.wind": "mean wind and gusts",
    "World.obstacles": "what stands around",
    "World.markers": "markers at their true poses",
    "World.arena": "where ground robots are in play",
    "World.robots": "ground robots to be herded",
    "World.obstacle_robots": "ground robots to keep away from",
    "Arena.centre": "north, east (m)",
    "Arena.side": "length of a side (m)",
    "Arena.goal": "the side over which robots are to go",
    "Robots.placed": "each robot, instead of the ring",
    "ObstacleRobots.placed": "each robot, instead of the circle",
    "PlacedRobot.at": "north, east (m)",
    "PlacedObstacle.at": "north, east (m)",
    "PlacedObstacle.tower": "height of its top above the ground (m)",
    "World.sensors": "noise and errors of the sensors",
    "World.battery": "its size, and the charge at the start",
    "World.quadrotor": "the airframe",
    "World.autopilot": "how the autopilot follows commands",
    "World.start": "where the vehicle stands at the start, north and east (m)",
    "Box.min": "corner with the least north, east and down (m)",
    "Box.max": "corner with the greatest north, east and down (m)",
    "Cylinder.at": "north, east of its axis (m)",
    "Sphere.at": "north, east, down of its centre (m)",
    "Ground.texture": "what the camera sees below",
    "Marker.dictionary": "of the marker",
    "Marker.id": "of the marker in its dictionary",
    "Marker.position": "north, east, down of its centre (m)",
    "Quadrotor.thrust_to_weight": "greatest thrust, in weights",
    "Wind.mean": "north, east, down (m/s)",
    "Sensors.imu": "accelerometer and gyroscope",
    "Sensors.gnss": "satellite receiver",
    "Sensors.baro": "barometer",
    "Sensors.magnetometer": "magnetometer",
    "Sensors.scan": "obstacle scanner",
    "Sensors.flow": "optical flow",
    "Sensors.range": "range finder, downwards",
    "FreeFlyerWorld.start": "where the chaser starts, at rest",
    "FreeFlyerWorld.anchors": "radio anchors by name: x, y, z (m), ranged to in this order",
    "FreeFlyerWorld.corridor": "a cone before the docked place, where the cubes may be close",
    "FreeFlyerWorld.capture": "when the docking mechanism takes hold",
    "FreeFlyerWorld.sensors": "noise and errors of the sensors",
    "FreeFlyerWorld.battery": "its size, and the charge at the start",
    "DockingTarget.name": "what the camera's features call it",
    "DockingTarget.position": "x, y, z of its centre (m)",
    "DockingTarget.attitude_deg": "about x, then the new y, then the new z",
    "DockingTarget.face": "to dock to: front +x, back -x, right +y, left -y, bottom +z, top -z",
    "DockingTarget.lit": "faces that carry features",
    "DockingTarget.features": "places on each face, from its middle (m)",
    "FlyerStart.position": "x, y, z of its centre (m)",
    "FlyerStart.attitude_deg": "about x, then the new y, then the new z",
    "FlyerSensors.gyro": "rate gyroscope",
    "FlyerSensors.accelerometer": "accelerometer",
    "FlyerSensors.uwb": "ranges by radio",
    "FlyerSensors.camera": "feature points of the target",
    "do": "actions when it is taken",
    "log": "line for the record and the terminal",
    "raise": "event raised in the chart",
    "assign": "variables to change",
    "set": "new value",
    "add": "number to add",
    "copy": "variable whose value it takes",
    "toggle": "turn true to false, and false to true",
    "Failsafe.vehicle": "request to the autopilot",
    "Start.vehicle": "request to the autopilot",
    "State.vehicle": "request to the autopilot",
    "Transition.vehicle": "request to the autopilot",
    "target": "name of a target",
    "of": "name of a target",
    "standoff": "out of the marker, to its right, up (m)",
    "guards.aruco_confidence.window": "frames that are counted",
    "guards.aruco_confidence.enter": "share of frames from which it holds",
    "guards.aruco_confidence.exit": "share of frames below which it no longer holds",
    "guards.battery_below.floor": "charge, 0 to 1",
    "guards.camera_silent.frames": "expected frames in a row",
    "guards.gps_to_visual.window": "frames that are counted",
    "guards.gps_to_visual.confidence": "share of frames with the marker, 0 to 1",
    "guards.inside_fence.north": "from and to (m)",
    "guards.inside_fence.east": "from and to (m)",
    "guards.ready.charge": "least charge, 0 to 1",
    "guards.tick_overrun.count": "late ticks from which it holds",
    "guards.tick_overrun.window": "last ticks that are counted",
    "guards.all": "guards that must all hold",
    "guards.any": "guards of which one must hold",
    "guards.not": "guard that must not hold",
    "guards.hysteresis": "guard whose value is latched",
    "guards.enter": "value at which the latch closes",
    "guards.exit": "value at which the latch opens",
    "guards.in": "name of a state",
    "guards.variable": "name of a variable",
    "guards.equals": "value that it must have",
    "guards.below": "value that it must be below",
    "guards.above": "value that it must be above",
    "guards.at_least": "least value",
    "guards.at_most": "greatest value",
    "behaviors.ddp_go_to.height": "to fly at (m); the target's if absent",
    "behaviors.follow_path.height": "to fly at (m); that of entry if absent",
    "behaviors.follow_path.neighbours": "cells that a step may lead to",
    "behaviors.follow_path.heuristic": "how the remaining distance is estimated",
    "behaviors.follow_path.smooth": "cut corners where the margin allows it",
    "behaviors.follow_path.heading": "where the nose points",
    "behaviors.follow_path.sigmas": "standard deviations of position kept from walls",
    "behaviors.go_to.height": "to fly at (m); the target's if absent",
    "behaviors.inject.payload": "name of the actuator",
    "behaviors.spiral.form": "how the spiral widens",
    "behaviors.take_off.by": "who climbs",
    "detectors.apriltag.dictionary": "family of the tag",
    "detectors.apriltag.id": "of the tag in its family",
    "detectors.apriltag.upright": "hangs as on a wall, its upper edge up",
    "detectors.aruco.dictionary": "of the marker",
    "detectors.aruco.id": "of the marker in its dictionary",
    "detectors.aruco.upright": "hangs as on a wall, its upper edge up",
    "herding_policies.dynamic_programme.turns": "how robots are turned",
    "herding_policies.dynamic_programme.bump_price": "chances to come home that a bump must gain",
    "herding_policies.dynamic_programme.touch_price": "the same of a touch",
    "herding_policies.dynamic_programme.time_price": "chances that a second of flight must gain",
    "herding_policies.nearest_to_goal.off_deg": "off the goal's direction: not towards it",
    "planners.potential_field.gain_xy": "η of the repulsion, level (m⁴/s)",
    "planners.potential_field.gain_z": "η of the repulsion, vertical (m⁴/s)",
    "planners.potential_field.attraction_gain": "of the pull to the goal (1/s)",
    "planners.potential_field.sight": "how far obstacles are seen (m); else as the scanner says",
}


def described(schema: dict[str, Any], whole: str) -> dict[str, Any]:
    """Return a schema in which every key that is known here has its description.

    Args:
        schema: with `$defs`; keys that have a description keep it.
        whole: name of the model that the file itself is.
    """
    definitions = {name: _filled(it, name) for name, it in schema.get("$defs", {}).items()}
    rest = {key: value for key, value in schema.items() if key != "$defs"}
    return {**_filled(rest, whole), "$defs": definitions}


def _filled(node: Any, where: str) -> Any:
    if isinstance(node, list):
        return [_filled(item, where) for item in node]
    if not isinstance(node, dict):
        return node
    filled = {key: it if key == "if" else _filled(it, where) for key, it in node.items()}
    if isinstance(keys := filled.get("properties"), dict):
        filled["properties"] = {key: _with_text(it, key, where) for key, it in keys.items()}
    return filled


def _with_text(value: Any, key: str, where: str) -> Any:
    text = DESCRIPTIONS.get(f"{where}.{key}", DESCRIPTIONS.get(key))
    if text is None or not isinstance(value, dict) or "description" in value or "const" in value:
        return value
    return {"description": text, **value}
