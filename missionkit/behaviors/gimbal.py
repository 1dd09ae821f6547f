"""Turning the gimbal of the camera."""

from __future__ import annotations

import math
from typing import ClassVar, Self

from pydantic import Field, PrivateAttr, model_validator
from typing_extensions import override

from missionkit.behaviors.devices import AtWork, Staying
from missionkit.camera_pointing import STALE, angles_to
from missionkit.geometry import vec, wrap
from missionkit.messages import CameraModel, Estimate, GimbalAim, GimbalAngles, Step
from missionkit.units import Degrees, Point, Seconds


class Gimbal(Staying):
    """Turn the camera's gimbal; done once it is `within_deg`, or after `patience` at the latest.

    To angles: `pitch_deg` from the horizon (up is positive, straight down -90) and `yaw_deg` from
    the vehicle's nose (right is positive). Or to look at a `target`, or at a `place` (north, east,
    down, m). The aim lasts: in later states too the gimbal keeps looking at the target or place,
    until another `gimbal` state gives it a new one. The vehicle stays where it is meanwhile.

    The mission's camera needs a `gimbal`, whose limits hold: what lies beyond them is not reached,
    and the state is done after `patience`. Over MAVLink by the gimbal protocol, version 2
    (MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW), or MAV_CMD_DO_MOUNT_CONTROL where that is not supported.
    While GIMBAL_DEVICE_ATTITUDE_STATUS is missing, frames of the camera are not used.
    """

    kind: ClassVar[str] = "gimbal"
    pitch_deg: Degrees | None = Field(
        default=None, ge=-90, le=90, description="from the horizon, up is positive"
    )
    yaw_deg: Degrees | None = Field(
        default=None, ge=-180, le=180, description="from the nose, right is positive"
    )
    target: str | None = Field(default=None, description="to look at")
    place: Point | None = Field(default=None, description="to look at: north, east, down (m)")
    within_deg: Degrees = Field(default=2.0, gt=0)
    patience: Seconds = Field(default=5.0, gt=0)

    _camera: CameraModel | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _one_aim(self) -> Self:
        angles = self.pitch_deg is not None or self.yaw_deg is not None
        if [angles, self.target is not None, self.place is not None].count(True) != 1:
            raise ValueError("give one aim: pitch_deg and yaw_deg, a target, or a place")
        return self

    @property
    def angles(self) -> GimbalAngles | None:
        """The angles to turn to (rad); None: it looks at something."""
        if self.target is not None or self.place is not None:
            return None
        return GimbalAngles(math.radians(self.pitch_deg or 0.0), math.radians(self.yaw_deg or 0.0))

    @override
    def with_camera(self, camera: CameraModel) -> Self:
        copied = self.model_copy()
        copied._camera = camera  # noqa: SLF001 - the copy is of this class
        return copied

    @override
    def targets(self) -> tuple[str, ...]:
        return () if self.target is None else (self.target,)

    @override
    def work(self, seen: Estimate, on: AtWork) -> Step:
        place = None if self.place is None else vec(*self.place)
        aim = GimbalAim(self.angles, place, self.target)
        off = self._off(aim, seen)
        late = seen.now - on.since >= self.patience
        note = "how it is turned is not known" if off is None else f"{off:.0f} deg off"
        done = late or (off is not None and off <= self.within_deg)
        return Step(done=done, note=note, memory=on, gimbal=aim)

    def _off(self, aim: GimbalAim, seen: Estimate) -> float | None:
        """Return how far (deg) the gimbal is from its aim; None: that is not known."""
        reading = seen.gimbal
        wanted = None if self._camera is None else angles_to(aim, self._camera, seen)
        if wanted is None or reading is None or seen.now - reading.at > STALE:
            return None
        pitch, yaw = reading.angles
        across = math.cos(wanted.pitch) * wrap(wanted.yaw - yaw)
        return math.degrees(math.hypot(wanted.pitch - pitch, across))
