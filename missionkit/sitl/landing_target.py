"""LANDING_TARGET, and the landing on it.

PX4 takes positions of its local frame and lands on them in the mode PRECLAND; ArduPilot takes what
is relative to the body, and lands on it in LAND and at the end of RTL if PLND_ENABLED. Sources: PX4
`mavlink_receiver.cpp`, `src/modules/navigator/precland.cpp`; ArduPilot `AC_PrecLand`.
"""

from __future__ import annotations

import numpy as np

from missionkit.geometry import rotate
from missionkit.messages import Action, Command
from missionkit.sim.pad_landing import PadTarget, velocity_to_pad
from missionkit.sitl.flight_primitives import act
from missionkit.sitl.peer_channel import Channel
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState

PRECISION_MODE = "PRECLAND"  # of PX4


def hear(state: SitlState, _: Channel, message: Message) -> None:
    """Take in where the pad is.

    Args:
        state: of the autopilot, changed.
        message: LANDING_TARGET.
    """
    place = np.array((message.x, message.y, message.z))
    px4 = state.dialect.name == "px4"
    frame = mavlink.MAV_FRAME_LOCAL_NED if px4 else mavlink.MAV_FRAME_BODY_FRD
    if not message.position_valid or message.frame != frame or not np.isfinite(place).all():
        return
    if not px4:
        place = state.body.position + rotate(state.body.attitude, place)
    state.pad = PadTarget(state.now, place)
    state.note("landing_target", f"{message.frame}")


def steer(state: SitlState) -> Command | None:
    """Land: on the pad in a precision landing, else where it is."""
    if state.dialect.name == "px4":
        precise = state.mode.name == PRECISION_MODE
    else:
        precise = bool(state.parameters["PLND_ENABLED"])
    if precise and state.phase != "touch_down":
        setpoint = velocity_to_pad(state.pad, state.body.position, state.now)
        if setpoint is not None:
            return Command(setpoint=setpoint)
        if state.pad is not None:
            state.begin("touch_down")
    return act(state, Action.LAND, "land")
