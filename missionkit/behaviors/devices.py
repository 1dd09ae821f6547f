"""Devices of the payload: photos, servos, relays, a gripper."""

from __future__ import annotations

import abc
import math
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import Vec3, norm
from missionkit.messages import Device, DeviceOrder, Estimate, Guidance, Step
from missionkit.plugin import Behavior
from missionkit.units import MetresPerSecond, Seconds

Number = Annotated[int, Field(ge=1, le=32, description="which of its kind")]
Pulse = Annotated[int, Field(ge=500, le=2500, json_schema_extra={"unit": "µs"})]


class AtWork(NamedTuple):
    """Memory of a device's behaviour."""

    place: Vec3  # (3,), m, NED, to stay at
    since: float  # s
    ordered: int = 0  # orders given so far
    ordered_at: float = -math.inf  # s


class Staying(Behavior):
    """What the behaviours of devices have in common: the vehicle stays where it was."""

    @override
    def begin(self, seen: Estimate) -> AtWork:
        return AtWork(seen.position, seen.now)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        step = self.work(seen, memory)
        if seen.status is None or not seen.status.in_air:
            return step
        return step._replace(guidance=Guidance(memory.place, speed=1.0))

    @abc.abstractmethod
    def work(self, seen: Estimate, on: AtWork) -> Step:
        """Return what the device does now.

        Args:
            seen: the estimate at this tick.
            on: memory.
        """


class Photo(Staying):
    """Take `count` photos from where the state was entered, `every` so many seconds; then done.

    Each waits until the vehicle is slower than `still`, for `patience` at most. The run's folder
    gets `photos.csv` with where each was taken from. Over MAVLink by the camera protocol
    (MAV_CMD_IMAGE_START_CAPTURE), or MAV_CMD_DO_DIGICAM_CONTROL where that is not supported; in
    the simulator the camera takes it at once. `survey` and `corridor` take photos by themselves:
    `front_overlap`.
    """

    kind: ClassVar[str] = "photo"
    count: Annotated[int, Field(ge=1, le=1000, description="photos")] = 1
    every: Seconds = Field(default=1.0, gt=0, description="from one to the next")
    still: MetresPerSecond = Field(default=0.3, gt=0, description="slower is sharp")
    patience: Seconds = Field(default=5.0, ge=0, description="for it to become so slow")

    @override
    def work(self, seen: Estimate, on: AtWork) -> Step:
        if on.ordered >= self.count:
            return Step(done=True, note=f"{on.ordered} photos", memory=on)
        due = seen.now - on.ordered_at >= self.every
        waited = seen.now - max(on.since, on.ordered_at + self.every)
        if not due or (norm(seen.velocity) > self.still and waited < self.patience):
            return Step(note=f"{on.ordered} of {self.count} photos", memory=on)
        on = on._replace(ordered=on.ordered + 1, ordered_at=seen.now)
        order = DeviceOrder(Device.CAMERA, 1, float(on.ordered))
        return Step(note=f"photo {on.ordered} of {self.count}", memory=on, orders=(order,))


class _Once(Staying):
    """Give one order, then wait."""

    wait: Seconds = Field(default=1.0, ge=0, description="until it is done")

    @abc.abstractmethod
    def order(self) -> DeviceOrder:
        """Return the order."""

    @override
    def work(self, seen: Estimate, on: AtWork) -> Step:
        if on.ordered:
            return Step(done=seen.now - on.ordered_at >= self.wait, memory=on)
        return Step(memory=on._replace(ordered=1, ordered_at=seen.now), orders=(self.order(),))


class SetServo(_Once):
    """Move servo `number` by a pulse of `pulse` (µs) and wait; it stays there.

    Over MAVLink MAV_CMD_DO_SET_SERVO; the vehicle stays where it is.
    """

    kind: ClassVar[str] = "set_servo"
    number: Number
    pulse: Pulse

    @override
    def order(self) -> DeviceOrder:
        return DeviceOrder(Device.SERVO, self.number, float(self.pulse))


class SetRelay(_Once):
    """Switch relay `number` on or off and wait; it stays so.

    Over MAVLink MAV_CMD_DO_SET_RELAY, which counts from 0: `number` 1 is its 0.
    """

    kind: ClassVar[str] = "set_relay"
    number: Number = 1
    switch: Literal["closed", "open"] = Field(default="closed", description="closed: current flows")

    @override
    def order(self) -> DeviceOrder:
        return DeviceOrder(Device.RELAY, self.number, float(self.switch == "closed"))


class Gripper(_Once):
    """Let the gripper grab or release, and wait for its motion.

    Over MAVLink MAV_CMD_DO_GRIPPER. Nothing says whether it holds anything.
    """

    kind: ClassVar[str] = "gripper"
    number: Number = 1
    action: Literal["grab", "release"] = Field(default="release", description="what it does")
    wait: Seconds = Field(default=2.0, ge=0, description="until it is done")

    @override
    def order(self) -> DeviceOrder:
        return DeviceOrder(Device.GRIPPER, self.number, float(self.action == "grab"))
