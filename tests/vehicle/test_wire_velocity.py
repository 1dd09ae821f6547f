"""An autopilot that is wrong about its own velocity; judged by how the vehicle really moves."""

import numpy as np
import pytest
from vehicle.flying import SPEED, over_the_wire

from missionkit.geometry import vec
from missionkit.messages import Command, Setpoint

REST = Setpoint(vec(0.0, 0.0, 0.0), 0.0)
WRONG = 0.25  # m/s


async def off_the_ground(flight, autopilot):
    """Take off; a machine that stalls is not the fault of the client."""
    for name in ("COM_OF_LOSS_T", "GUID_TIMEOUT"):
        autopilot.ask(parameter=name, value=60.0)
    await flight.take_off()


def drifting(autopilot):
    """Return how fast (m/s) it has really moved in the last second."""
    rows = np.array(autopilot.ask(track=True, since=autopilot.now - 1.0)["rows"], dtype=float)
    return float(np.hypot(*rows[:, 4:6].mean(axis=0)))


def seeing(autopilot):
    """Return what tells it to stand still, and how fast it really moves."""
    return lambda: Command(REST, own_velocity=vec(*autopilot.truth["velocity"]))


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_velocity_is_flown_although_the_autopilot_is_wrong_about_its_own(dialect, tmp_path):
    async def script(flight, autopilot):
        await off_the_ground(flight, autopilot)
        autopilot.ask(fault=f"velocity_bias={WRONG}")
        await flight.until(lambda: drifting(autopilot) > 0.6 * WRONG, Command(REST))
        autopilot.ask(fault="control_slow=0.1")
        await flight.until(lambda: drifting(autopilot) < 0.25 * WRONG, seeing(autopilot))

    over_the_wire(tmp_path, script, dialect, speed=SPEED)


def test_without_the_autopilots_velocity_nothing_is_corrected(tmp_path):
    async def script(flight, autopilot):
        await off_the_ground(flight, autopilot)
        autopilot.ask(fault=f"velocity_bias={WRONG}")
        await flight.run(3.0, Command(REST))
        await flight.until(lambda: drifting(autopilot) < 0.25 * WRONG, seeing(autopilot))
        autopilot.ask(fault="stream_lost=32")
        await flight.until(lambda: drifting(autopilot) > 0.6 * WRONG, seeing(autopilot))

    over_the_wire(tmp_path, script, speed=SPEED)
