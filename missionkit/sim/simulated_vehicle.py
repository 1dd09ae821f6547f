"""A vehicle that exists only here: body, autopilot, sensors, camera, faults.

Imported late: it compiles kernels.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import TYPE_CHECKING

from typing_extensions import override

from missionkit.geometry import GRAVITY, Mat, to_matrix, vec, yaw_of
from missionkit.messages import (
    NO_CYCLE,
    Action,
    Command,
    Device,
    GimbalReading,
    Gnss,
    Imu,
    Observation,
    Scan,
    VehicleStatus,
)
from missionkit.sim import disturbances, kernel_layout
from missionkit.sim.autopilot_flight import AutopilotFlight
from missionkit.sim.camera_feed import Feed
from missionkit.sim.fault_injection import Fault, InjectedFaults, refuse_foreign
from missionkit.sim.flow_sensor import FlowSensor, RangeSensor
from missionkit.sim.gimbal import SimulatedGimbal
from missionkit.sim.ground_truth import TrueTrack
from missionkit.sim.herd_grading import HerdTrack
from missionkit.sim.obstacle_distance import ring
from missionkit.sim.pad_landing import PadTarget
from missionkit.sim.plant import Plant
from missionkit.sim.position_control import velocity_for
from missionkit.sim.random_blocks import Normals, streams
from missionkit.sim.sensor_inbox import Inbox
from missionkit.sim.sensors import (
    BaroSensor,
    BatteryGauge,
    Beat,
    ExternalPoseSensor,
    GnssSensor,
    MagnetometerSensor,
)
from missionkit.sim.simulated_port import STRETCH, SimulatedPort
from missionkit.sim.world import World

if TYPE_CHECKING:
    from missionkit.perception.camera_section import Camera

RAYS = 72


class SimulatedVehicle(SimulatedPort):
    """A simulated quadrotor behind the port `Vehicle`; two runs with one seed are bit-identical.

    Time passes only in `advance`. The synchronous methods do the work; `connect`, `observe`,
    `send` and `close` implement the port.

    Args:
        world: obstacles, markers, wind, sensors.
        camera: the mission's camera.
        seed: of all randomness; every sensor has its own stream.
        faults: what goes wrong, and when.

    Raises:
        UsageError: a fault that a multicopter does not have.
    """

    def __init__(
        self, world: World, camera: Camera, seed: int, faults: Sequence[Fault] = ()
    ) -> None:
        refuse_foreign(faults, world.FAULTS, world.VEHICLE)
        rngs = streams(seed)
        self.world = world
        self.track = TrueTrack()
        self.herd = HerdTrack()
        self.payload: str | None = None  # actuator that is on
        self.devices: dict[str, float] = {}  # as ordered last: "servo 1" in µs, "relay 1", …
        self.photos: tuple[float, ...] = ()  # s, when each was taken
        self._injected = InjectedFaults(tuple(faults), {})
        self._plant = Plant(world, rngs)
        self._feed = Feed(camera, world, self._plant.things, rngs["camera"], rngs["boxes"])
        self._gimbal: SimulatedGimbal | None = None
        if camera.gimbal is not None:
            self._gimbal = SimulatedGimbal(camera.gimbal, camera.mount, rngs["gimbal"])
        self._gnss = GnssSensor(world.sensors.gnss, rngs["gnss"])
        self._baro = BaroSensor(world.sensors.baro, rngs["baro"])
        self._mag = MagnetometerSensor(world.sensors.magnetometer, rngs["magnetometer"])
        self._flow = FlowSensor(world.sensors.flow, rngs["flow"])
        self._range = RangeSensor(world.sensors.range, rngs["range"])
        outside = world.sensors.external_pose
        self._outside = None
        if outside is not None:
            self._outside = ExternalPoseSensor(outside, rngs["external_pose"])
        self._gauge = BatteryGauge(world.battery)
        self._scan = Beat(world.sensors.scan.rate)
        self._heartbeat = Beat(5.0)
        self._ranges = Normals(rngs["scan"], RAYS, 100)
        self._link = rngs["link"]
        self._fixes: deque[Gnss] = deque()
        self._orders: deque[tuple[int, Action, float | None]] = deque()
        self._own = AutopilotFlight(world.autopilot.return_height)
        self._cycle = NO_CYCLE
        self._ids = frozenset(marker.id for marker in world.all_markers)
        self._inbox = Inbox()
        self._flow.start(self.now, self._plant.state)
        self._remember()

    @property
    def now(self) -> float:
        """Simulated time (s)."""
        return self._plant.now

    @property
    def robots(self) -> Mat:
        """True states of the ground robots (R, SIZE), see `ground_robots`, not to be changed."""
        return self._plant.robots

    @property
    def traffic_lost(self) -> bool:
        """Whether it neither hears the other vehicles of a fleet nor is heard."""
        return self._injected.active("traffic_lost", self.now)

    def collide(self) -> None:
        """Crash: another vehicle has hit it."""
        self._plant.memory[kernel_layout.CRASHED] = 1.0

    @property
    def ready(self) -> bool:
        """Whether the autopilot's arming checks pass."""
        memory = self._plant.memory
        return bool(
            self.now >= 1.0
            and memory[kernel_layout.GNSS_OK]
            and memory[kernel_layout.ON_GROUND]
            and not memory[kernel_layout.CRASHED]
            and self._charge >= self.world.autopilot.arming_charge
        )

    @override
    def apply(self, command: Command) -> None:
        """Send a command; it arrives 20 to 40 ms later.

        Without setpoint and action a vehicle in offboard mode has to hold; one that takes off,
        lands, holds or flies home is left alone. RETURN is refused, which an event says, on the
        ground and without satellites.

        Raises:
            VehicleError: the setpoint is one that is not flown here.
        """
        low, high = self.world.autopilot.latency
        due = self.now + low + (high - low) * self._link.random()
        self.payload = command.payload
        for order in command.orders:
            if order.device is Device.CAMERA:
                self.photos = (*self.photos, self.now)
            else:
                named = {f"{order.device} {order.number}": order.value}
                self.devices = {**self.devices, **named}
        if command.gimbal is not None and self._gimbal is not None:
            self._gimbal.order(command.gimbal, self.now)
        if command.landing_target is not None:
            here = self._plant.state[:3]
            self._own.hear(PadTarget(self.now, here + command.landing_target.offset))
        action = command.action
        steered = self._plant.mode == kernel_layout.OFFBOARD and not self._own.mode
        if action is None and command.setpoint is None and steered:
            action = Action.HOLD
        if action is not None:
            step = max(self._plant.step + 1, round(due * kernel_layout.RATE))
            self._orders.append((step, action, command.height))
        if command.setpoint is not None:
            self._own.end()
            self._plant.tell(velocity_for(command.setpoint, self._plant.state), due)

    @override
    def advance(self, until: float) -> Observation:
        """Fly to mission time `until` (s) and return all that arrived on the way."""
        target = round(until * kernel_layout.RATE)
        while self._plant.step < target:
            stop = min(target, self._plant.step + STRETCH, self._feed.next_step)
            if self._orders:
                stop = min(stop, max(self._orders[0][0], self._plant.step + 1))
            self._fly(stop)
            self._obey()
            self._sense()
        box, self._inbox = self._inbox, Inbox()
        self._cycle = self._injected.load(until, self._cycle)
        return Observation(
            now=until,
            imu=tuple(box.imu),
            gnss=box.gnss,
            baro=box.baro,
            mag=box.mag,
            frame=self._feed.deliver(self.now),
            scan=box.scan,
            battery=box.battery,
            status=box.status,
            events=tuple(box.events),
            cycle=self._cycle,
            flow=box.flow,
            range=box.range,
            external_pose=None if self._outside is None else self._outside.deliver(self.now),
            gimbal=self._gimbal_reading(),
            utc=self.utc(until),
        )

    @property
    def _charge(self) -> float:
        return self._gauge.charge(float(self._plant.memory[kernel_layout.ENERGY]))

    def _fly(self, stop: int) -> None:
        plant = self._plant
        if self._own.mode:
            self._own.steer(plant, ready=self.ready)
        first = plant.step // kernel_layout.IMU_EVERY + 1
        faults = self._injected
        plant.mislead(
            disturbances.velocity_bias(faults, self.now),
            disturbances.control_period(faults, self.now),
        )
        wind = vec(*self.world.wind.mean)
        rows = plant.advance(stop, disturbances.extra_wind(faults, wind, self.now))
        period = kernel_layout.IMU_EVERY / kernel_layout.RATE
        biased = self._injected.since("imu_biased", self.now)
        if biased is not None:
            rows[:, 0] += biased[0]
        self._inbox.imu += [
            Imu((first + n) * period, row[:3], row[3:]) for n, row in enumerate(rows)
        ]
        sag = self._injected.since("battery_sag", self.now)
        self._gauge.sag = max(self._gauge.sag, sag[0] if sag else 0.0)
        plant.memory[kernel_layout.POWERED] = float(self._charge > 0.0)
        self._remember()

    def _remember(self) -> None:
        memory = self._plant.memory
        rest = (
            memory[kernel_layout.ON_GROUND],
            memory[kernel_layout.ARMED],
            memory[kernel_layout.MODE],
            memory[kernel_layout.CRASHED],
            self._charge,
            memory[kernel_layout.CLEARANCE],
            memory[kernel_layout.ENERGY],
        )
        self.track.add(self.now, self._plant.state[:13], rest)
        if len(self.robots):
            self.herd.add(self.now, self.robots)

    def _obey(self) -> None:
        while self._orders and self._orders[0][0] <= self._plant.step:
            _, action, height = self._orders.popleft()
            if not self._ordered(action, height):
                self._inbox.events.append(f"{action}_refused")

    def _ordered(self, action: Action, height: float | None) -> bool:
        """Carry out an action now; return whether the autopilot accepted it."""
        plant = self._plant
        if action is Action.PRECISION_LAND:
            return self._own.land_precisely(plant)
        if action is Action.RETURN:
            return self._own.go_home(plant)
        taken = plant.order(action, height, ready=self.ready)
        if taken:
            self._own.end()
        if taken and action is Action.ARM:
            self._own.armed_at(plant.state)
        return taken

    def _sense(self) -> None:
        step, now = self._plant.step, self.now
        x, box = self._plant.state, self._inbox
        self._take_fix(step, now)
        if self._baro.beat.due(step):
            stuck = self._injected.active("baro_stuck", now)
            box.baro = self._baro.measure(now, x, stuck=stuck)
        if self._mag.beat.due(step):
            box.mag = self._mag.measure(now, x)
        if self._flow.beat.due(step):
            box.flow = self._flow.measure(now, self._plant.above_surface())
        if self._range.beat.due(step):
            seen = self._range.measure(now, self._plant.above_surface())
            box.range = None if self._injected.active("range_lost", now) else seen
        if self._outside is not None and self._outside.beat.due(step):
            self._outside.expose(now, x, lost=self._injected.active("external_pose_lost", now))
        if self._scan.due(step):
            box.scan = self._look_around(now)
        if step == self._feed.next_step:
            self._expose(now)
        self._telemetry(step, now)

    @property
    def _aiding(self) -> float:
        """Whether fixes correct the autopilot's own velocity, as in `kernel_layout.GNSS_OK`."""
        return float(self._injected.without_fixes(self.now) is None)

    def _take_fix(self, step: int, now: float) -> None:
        lost = self._injected.without_fixes(now) is not None
        self._plant.memory[kernel_layout.GNSS_OK] = self._aiding
        if self._gnss.beat.due(step):
            offset = disturbances.satellite_offset(self._injected, now)
            fix = self._gnss.measure(now, self._plant.state, offset)
            if not lost:
                self._fixes.append(fix)
        while self._fixes and self._fixes[0].at + self._gnss.latency <= now + 1e-9:
            self._inbox.gnss = self._fixes.popleft()

    def _look_around(self, now: float) -> Scan:
        x, model = self._plant.state, self.world.sensors.scan
        noise = model.sd * self._ranges.take(1)[0]
        points = ring(self._plant.things, x[:3], yaw_of(x[6:10]), model.range, noise)
        turned = points @ to_matrix(x[6:10]) if len(points) else points
        return Scan(now, turned, model.range)

    def _expose(self, now: float) -> None:
        faults = self._injected
        self._feed.expose(
            self._plant.state,
            self.robots,
            hidden=faults.hidden(now, self._ids),
            delay=(faults.since("camera_delayed", now) or (0.0, 0.0))[0],
            off=faults.active("camera_off", now),
            frozen=faults.active("camera_frozen", now),
            flipped=faults.active("camera_flipped", now),
            gimbal=self._gimbal,
            gimbal_lost=faults.active("gimbal_lost", now),
        )

    def _gimbal_reading(self) -> GimbalReading | None:
        if self._gimbal is None or self._injected.active("gimbal_lost", self.now):
            return None
        return GimbalReading(self.now, self._gimbal.measured(self.now))

    def _telemetry(self, step: int, now: float) -> None:
        battery, heartbeat = self._gauge.beat.due(step), self._heartbeat.due(step)
        if self._injected.active("link_lost", now):
            return
        plant = self._plant
        if battery:
            energy = float(plant.memory[kernel_layout.ENERGY])
            self._inbox.battery = self._gauge.measure(now, energy, self._power())
        if heartbeat:
            mode = self._own.mode or kernel_layout.MODES[plant.mode]
            self._inbox.status = VehicleStatus(
                now, plant.armed, not plant.on_ground, self.ready, mode
            )

    def _power(self) -> float:
        """Return the power (W) that the rotors take now, or took in the last stretch flown."""
        quad = self.world.quadrotor
        if quad.rotors is not None:
            before, last = self.track.rows[-2:]
            return float((last[-1] - before[-1]) / (last[0] - before[0]))
        thrusts = self._plant.state[13:17].clip(0.0)
        hover = quad.mass * GRAVITY / 4.0
        return quad.hover_power * float(((thrusts / hover) ** 1.5).mean())
