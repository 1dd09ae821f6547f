"""What the simulated autopilot flies by itself: the way home, and a landing on a pad."""

from __future__ import annotations

from missionkit.geometry import Vec3
from missionkit.messages import Action
from missionkit.sim import kernel_layout
from missionkit.sim.pad_landing import PadTarget, velocity_to_pad
from missionkit.sim.plant import Plant
from missionkit.sim.return_flight import ReturnFlight, velocity_home


class AutopilotFlight:
    """One of the two at most, until it ends, or a setpoint or another order ends it.

    Args:
        height: m, to which it rises at least on its way home.
    """

    def __init__(self, height: float) -> None:
        self._height = height
        self._home = (0.0, 0.0)  # m, north and east, where it armed
        self._return: ReturnFlight | None = None
        self._precise = False
        self._pad: PadTarget | None = None

    @property
    def mode(self) -> str:
        """Name of its mode; "" while it flies neither."""
        if self._precise:
            return "precision_land"
        return "" if self._return is None else "return"

    def armed_at(self, state: Vec3) -> None:
        """Remember where the vehicle armed.

        Args:
            state: (17,), as in `kernel_layout`.
        """
        self._home = float(state[0]), float(state[1])

    def hear(self, pad: PadTarget) -> None:
        """Take in where the pad is."""
        self._pad = pad

    def end(self) -> None:
        """Fly neither."""
        self._return, self._precise = None, False

    def go_home(self, plant: Plant) -> bool:
        """Begin the way home, or go on with it; return whether the autopilot does."""
        able = plant.armed and not plant.on_ground
        if not able or plant.memory[kernel_layout.GNSS_OK] <= 0.0:
            return False
        if self._return is None:
            self._return = ReturnFlight.begun(self._home, plant.state, self._height)
            self._precise = False
        return True

    def land_precisely(self, plant: Plant) -> bool:
        """Begin to land on the pad, or go on with it; return whether the autopilot does."""
        if not plant.armed or plant.on_ground:
            return False
        landing = kernel_layout.MODES[plant.mode] == "land"
        if not self._precise and not landing:
            self._return, self._precise = None, True
        return True

    def steer(self, plant: Plant, *, ready: bool) -> None:
        """Steer the next stretch of what it flies; land where that ends.

        Args:
            plant: that flies.
            ready: whether the arming checks pass.
        """
        if self._return is not None:
            velocity = velocity_home(self._return, plant.state)
        else:
            velocity = velocity_to_pad(self._pad, plant.state[:3], plant.now)
        if velocity is not None:
            plant.tell(velocity, plant.now)
            return
        self.end()
        plant.order(Action.LAND, None, ready=ready)
