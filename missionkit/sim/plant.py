"""The flying part of the simulator: state, kernels, and the autopilot's orders.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat, Vec3, from_euler
from missionkit.messages import Action, Setpoint
from missionkit.sim import kernel_layout as at
from missionkit.sim.obstacle_distance import table
from missionkit.sim.physics_steps import fly
from missionkit.sim.random_blocks import Normals
from missionkit.sim.rigid_body import over_deck, surface
from missionkit.sim.robot_contact import start
from missionkit.sim.world import World


class Plant:
    """Body, inner autopilot, wind and inertial unit, advanced together by one kernel."""

    def __init__(self, world: World, rngs: dict[str, np.random.Generator]) -> None:
        herd = start(world, rngs["robots"])
        self.robots = herd.robots
        self.things = np.vstack((table(world), herd.things))
        self.step = 0
        self.state = np.zeros(17)
        self.memory = np.zeros(at.SIZE)
        self._constants = (*herd.constants, *at.constants(world))
        self._wind = Normals(rngs["wind"], 3)
        self._own = Normals(rngs["autopilot"], 3)
        self._imu = Normals(rngs["imu"], 12)
        self._place(world)
        self._begin(world)
        self._raise_deck(world)

    def _place(self, world: World) -> None:
        self.state[:2] = world.start
        self.state[6:10] = from_euler(0.0, 0.0, math.radians(world.start_yaw_deg))

    def _begin(self, world: World) -> None:
        memory, imu = self.memory, world.sensors.imu
        memory[[at.ON_GROUND, at.GNSS_OK, at.POWERED]] = 1.0
        memory[[at.LANDED_AT, at.DUE_AT, at.CLEARANCE]] = math.inf
        memory[at.GUST : at.GUST + 3] = world.wind.gust * self._wind.take(1)[0] * (1.0, 1.0, 0.5)
        errors = world.autopilot.velocity_sd * self._own.take(1)[0] * (1.0, 1.0, 0.5)
        memory[at.VELOCITY_ERROR : at.VELOCITY_ERROR + 3] = errors
        biases = self._imu.take(1)[0]
        memory[at.ACCEL_BIAS : at.ACCEL_BIAS + 3] = imu.accel_bias * biases[:3]
        memory[at.GYRO_BIAS : at.GYRO_BIAS + 3] = imu.gyro_bias * biases[3:6]

    def _raise_deck(self, world: World) -> None:
        deck, memory = world.deck, self.memory
        if deck is None:
            return
        memory[at.DECK_HALF], memory[at.DECK_DOWN] = 0.5 * deck.size, -deck.height
        memory[at.DECK_SLOPE : at.DECK_SLOPE + 2] = deck.slope
        memory[at.DECK_AT : at.DECK_AT + 2] = deck.at
        memory[at.DECK_VELOCITY : at.DECK_VELOCITY + 2] = deck.velocity
        memory[at.DECK_TURN] = math.radians(deck.turn_rate_deg)

    def above_surface(self) -> Vec3:
        """Return the state (17,) with the position from the deck where it is above that."""
        x, memory = self.state, self.memory
        if memory[at.DECK_HALF] <= 0.0 or not over_deck(x, memory):
            return x
        x = x.copy()
        down = surface(x, memory)
        x[0:2] -= memory[at.DECK_AT : at.DECK_AT + 2]
        x[2] -= down
        return x

    @property
    def now(self) -> float:
        """Simulated time (s)."""
        return self.step / at.RATE

    @property
    def mode(self) -> int:
        """The autopilot's mode, one of `kernel_layout.HOLD` and its siblings."""
        return int(self.memory[at.MODE])

    @property
    def on_ground(self) -> bool:
        """Whether the feet touch the ground."""
        return bool(self.memory[at.ON_GROUND])

    @property
    def armed(self) -> bool:
        """Whether the rotors turn."""
        return bool(self.memory[at.ARMED])

    def advance(self, stop: int, extra: Vec3 | None = None) -> Mat:
        """Fly to physics step `stop`; return the inertial samples (n, 6), every second step.

        Args:
            stop: number of steps since the start.
            extra: (3,) m/s, NED, wind on top of the world's.
        """
        count = stop - self.step
        samples = stop // at.IMU_EVERY - self.step // at.IMU_EVERY
        out: Mat = fly(
            self.state,
            self.memory,
            self.step,
            np.zeros(3) if extra is None else extra,
            self.things,
            self.robots,
            *self._constants,
            self._wind.take(count),
            self._own.take(count),
            self._imu.take(samples),
        )
        self.step = stop
        return out

    def mislead(self, bias: Vec3, period: float) -> None:
        """Let the autopilot be wrong about its velocity, and slow to correct it.

        Args:
            bias: (3,), m/s, NED, of the velocity it believes in.
            period: s, of its velocity loop; 0: that of the physics.
        """
        memory = self.memory
        memory[at.VELOCITY_ERROR : at.VELOCITY_ERROR + 3] += (
            bias - memory[at.VELOCITY_BIAS : at.VELOCITY_BIAS + 3]
        )
        memory[at.VELOCITY_BIAS : at.VELOCITY_BIAS + 3] = bias
        memory[at.LOOP_PERIOD] = period

    def tell(self, setpoint: Setpoint, due: float) -> None:
        """Send a setpoint that arrives at `due` (s); one still on its way is overtaken."""
        memory = self.memory
        memory[at.DUE : at.DUE + 3] = setpoint.velocity
        memory[at.DUE + 3] = setpoint.yaw_rate
        memory[at.DUE_AT] = min(due, memory[at.DUE_AT])

    def order(self, action: Action, height: float | None, *, ready: bool) -> bool:
        """Carry out an action now; return whether the autopilot accepted it.

        Args:
            action: what to do.
            height: m above the ground, for TAKE_OFF (2.5 m without one).
            ready: whether the arming checks pass.
        """
        memory = self.memory
        if action is Action.ARM:
            if ready:
                memory[at.ARMED] = 1.0
            return ready
        if action is Action.DISARM:
            if self.on_ground:
                memory[[at.ARMED, at.MODE]] = 0.0
            return self.on_ground
        if not self.armed:
            return False
        modes = {Action.TAKE_OFF: at.TAKE_OFF, Action.HOLD: at.HOLD, Action.LAND: at.LAND}
        memory[at.HEIGHT] = 2.5 if height is None else height
        self._enter(modes[action])
        return True

    def _enter(self, mode: int) -> None:
        if self.mode != mode:
            self.memory[at.MODE] = mode
            self.memory[at.ANCHORED] = 0.0
        self.memory[at.DUE_AT] = math.inf  # a setpoint sent before must not undo the action
