"""The simulator's vehicle, as the autopilot around it needs it."""

from __future__ import annotations

from collections.abc import Sequence

from typing_extensions import override

from missionkit.geometry import Quat, Vec3
from missionkit.messages import Action
from missionkit.perception.camera_section import Camera
from missionkit.sim import kernel_layout
from missionkit.sim.fault_injection import Fault
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import World


class SimulatedBody(SimulatedVehicle):
    """A simulated quadrotor without camera, that obeys at once: the delay is the link's.

    Args:
        world: obstacles, wind, sensors.
        seed: of all randomness.
        faults: what goes wrong, and when.
    """

    def __init__(self, world: World, seed: int, faults: Sequence[Fault] = ()) -> None:
        prompt = world.autopilot.model_copy(update={"latency": (0.0, 0.0)})
        prompt_world = world.model_copy(update={"autopilot": prompt})
        self.by_flow = False  # its estimator has optical flow
        super().__init__(prompt_world, Camera(use="none"), seed, faults)

    @property
    def position(self) -> Vec3:
        """Where the autopilot believes it is, (3,), m, NED."""
        error = self._plant.memory[kernel_layout.POSITION_ERROR : kernel_layout.POSITION_ERROR + 3]
        believed: Vec3 = self._plant.state[:3] + error
        return believed

    @property
    def velocity(self) -> Vec3:
        """How fast the autopilot believes it is, (3,), m/s, NED."""
        error = self._plant.memory[kernel_layout.VELOCITY_ERROR : kernel_layout.VELOCITY_ERROR + 3]
        believed: Vec3 = self._plant.state[3:6] + error
        return believed

    @property
    def attitude(self) -> Quat:
        """Body to world, (4,), which the autopilot knows exactly."""
        turned: Quat = self._plant.state[6:10].copy()
        return turned

    @property
    def rates(self) -> Vec3:
        """Turn rates, (3,), rad/s, FRD, which the autopilot knows exactly."""
        turning: Vec3 = self._plant.state[10:13].copy()
        return turning

    @property
    def charge(self) -> float:
        """Charge of the battery, 0 to 1."""
        return self._charge

    @property
    def power(self) -> float:
        """Power of the rotors (W)."""
        return self._power() if self._plant.armed else 0.0

    @property
    def armed(self) -> bool:
        """Whether the rotors turn, at this very moment."""
        return self._plant.armed

    @property
    def on_ground(self) -> bool:
        """Whether the feet touch the ground."""
        return self._plant.on_ground

    def arm(self) -> None:
        """Start the rotors; the checks are done."""
        self._plant.order(Action.ARM, None, ready=True)

    def unwind(self) -> None:
        """Forget what the velocity loop has learnt of wind and drag: the next setpoint leans."""
        self._plant.memory[kernel_layout.INTEGRAL : kernel_layout.INTEGRAL + 3] = 0.0

    @property
    @override
    def _aiding(self) -> float:
        return max(super()._aiding, kernel_layout.FLOW_AIDED if self.by_flow else 0.0)

    def faulty(self, faults: Sequence[Fault]) -> None:
        """Let these faults take the place of all others from now on."""
        self._injected = self._injected._replace(faults=tuple(faults))

    def kill(self) -> None:
        """Stop the rotors, also in flight."""
        self._plant.memory[[kernel_layout.ARMED, kernel_layout.MODE]] = 0.0
