"""Types of vehicle (MAV_TYPE), and which of them missionkit flies.

Missions hover, stop and turn on the spot: a fixed wing cannot, and a rover takes "take off" for
something else. Source: MAVLink minimal.xml, MAV_TYPE.
"""

from __future__ import annotations

from collections.abc import Mapping

from missionkit.vehicle.link.message_cache import Fields

MULTICOPTERS: Mapping[int, str] = {
    2: "quadrotor",
    3: "coaxial helicopter",
    4: "helicopter",
    13: "hexarotor",
    14: "octorotor",
    15: "tricopter",
    29: "dodecarotor",
    35: "decarotor",
    43: "multirotor",
}
OTHERS: Mapping[int, str] = {
    0: "generic vehicle",
    1: "fixed wing",
    5: "antenna tracker",
    6: "ground station",
    7: "airship",
    8: "free balloon",
    9: "rocket",
    10: "ground rover",
    11: "surface boat",
    12: "submarine",
    16: "flapping wing",
    17: "kite",
    18: "companion computer",
    19: "tail-sitter VTOL with two rotors",
    20: "tail-sitter VTOL with four rotors",
    21: "tilt-rotor VTOL",
    22: "VTOL",
    23: "tail-sitter VTOL",
    24: "tilt-wing VTOL",
    25: "VTOL",
    28: "parafoil",
}
AUTOPILOTS: Mapping[int, str] = {3: "ArduPilot", 12: "PX4"}


def type_name(number: int) -> str:
    """Return the name of a MAV_TYPE.

    >>> type_name(1)
    'fixed wing'
    """
    return MULTICOPTERS.get(number) or OTHERS.get(number) or f"vehicle of MAV_TYPE {number}"


def described(beat: Fields) -> str:
    """Return what a heartbeat says of who sends it, such as `PX4 quadrotor`."""
    autopilot = int(beat["autopilot"])
    name = AUTOPILOTS.get(autopilot, f"autopilot of MAV_AUTOPILOT {autopilot}:")
    return f"{name} {type_name(int(beat['type']))}"


def unfit(beat: Fields) -> str:
    """Return why missionkit does not fly the vehicle of a heartbeat, "" if it does."""
    if int(beat["autopilot"]) not in AUTOPILOTS:
        return (
            f"its autopilot is of MAV_AUTOPILOT {beat['autopilot']}; "
            "missionkit flies PX4 and ArduPilot"
        )
    if int(beat["type"]) not in MULTICOPTERS:
        number = int(beat["type"])
        return (
            f"it is a {type_name(number)} (MAV_TYPE {number}); "
            "missionkit flies multicopters and helicopters only"
        )
    return ""
