"""Where a free flyer is to be, and how it is turned, to dock to a face of a target (P3, section V).

It docks with its bottom, where its camera is (`docking_geometry`).
"""

from __future__ import annotations

import math
from typing import ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.docking_geometry import NORMALS, Face, face_rotation
from missionkit.geometry import (
    Quat,
    Vec3,
    across,
    conjugate,
    cross,
    exp,
    multiply,
    norm,
    normalised,
    rotate,
    vec,
)
from missionkit.geometry import log as rotation_vector
from missionkit.messages import Estimate, Goal, Step, Target
from missionkit.plugin import Behavior
from missionkit.units import Degrees, Metres, MetresPerSecond

LOOKS = vec(0.0, 0.0, 1.0)
"""Where the camera looks, in body axes: out of the bottom."""


class DockingPose(NamedTuple):
    """A target's docking face, in the world."""

    target: str
    centre: Vec3  # (3,), m, of the target
    axis: Vec3  # (3,), unit, out of its face
    attitude: Quat  # (4,), body to world of a docked vehicle

    def at(self, distance: float) -> Vec3:
        """Return the place (3,), m, in front of the face, `distance` (m) from the centre."""
        return self.centre + distance * self.axis

    def beside(self, position: Vec3, distance: float, most: float) -> Vec3:
        """Return the place (3,), m, `distance` (m) from the centre that is nearest to `position`.

        It is in front of the face, and at most `most` off the docking axis.

        Args:
            position: (3,), m, of the vehicle.
            distance: m, from the target's centre.
            most: m, from the docking axis.
        """
        away = position - self.centre
        along = float(away @ self.axis)
        across = away - along * self.axis
        wide, length = norm(across), norm(away)
        if wide == 0.0:
            return self.at(distance)
        off = min(most, distance * (wide / length if along > 0.0 else 1.0))
        return self.at(math.sqrt(distance**2 - off**2)) + off / wide * across

    def towards(self, position: Vec3, distance: float) -> Vec3 | None:
        """Return the place (3,), m, `distance` (m) from the centre on the line to `position`.

        None at the centre itself, where there is no line.
        """
        away = position - self.centre
        length = norm(away)
        return None if length == 0.0 else self.centre + distance / length * away

    def misalignment(self, attitude: Quat) -> float:
        """Return the angle (rad) between an attitude and that of a docked vehicle."""
        return norm(rotation_vector(multiply(conjugate(self.attitude), attitude)))


class DockingBehavior(Behavior):
    """Parameters shared by the docking behaviours: the target, its face, and the camera."""

    kind: ClassVar[str]
    target: str
    face: Face = Field(default="top", description="of the target, to dock to")
    roll_deg: Degrees = Field(default=0.0, description="of the docked vehicle, about the axis")
    speed: MetresPerSecond = Field(default=0.014, gt=0)
    keep_out: Metres = Field(default=0.2, ge=0, description="from the target's centre")
    camera: str | None = Field(default=None, description="actuator that is on meanwhile")

    @override
    def targets(self) -> tuple[str, ...]:
        return (self.target,)

    def pose(self, seen: Estimate) -> DockingPose | None:
        """Return the docking face, None while place or attitude of the target is not known."""
        target = seen.targets.get(self.target)
        return None if target is None else docking_pose(target, self.face, self.roll_deg)

    def lost(self, memory: object) -> Step:
        """Return the answer while the target is not known: hold."""
        note = f"where {self.target} is, and how it is turned, is not known"
        return Step(note=note, payload=self.camera, memory=memory)

    def goal(self, position: Vec3, seen: Estimate) -> Goal:
        """Return where the behaviour leads, for guards and the record."""
        return Goal(position, None, seen.now, self.target)


def docking_pose(target: Target, face: Face, roll_deg: float = 0.0) -> DockingPose | None:
    """Return a target's docking face in the world; None if the target's attitude is not known.

    Args:
        target: its attitude turns its own axes into the world's.
        face: of the target.
        roll_deg: of the docked vehicle about the docking axis.
    """
    if target.attitude is None:
        return None
    return DockingPose(
        target.name,
        target.position,
        rotate(target.attitude, vec(*NORMALS[face])),
        normalised(multiply(target.attitude, face_rotation(face, roll_deg))),
    )


def looking_at(pose: DockingPose, position: Vec3) -> Quat:
    """Return the attitude at `position` (3,) that looks at the target, turned least from docked.

    In front of the face it is that of a docked vehicle.
    """
    away = pose.centre - position
    if norm(away) < 1e-6:
        return pose.attitude
    looks = rotate(pose.attitude, LOOKS)
    return multiply(shortest(looks, away / norm(away)), pose.attitude)


def shortest(a: Vec3, b: Vec3) -> Quat:
    """Return the smallest rotation (4,) that turns unit vector a (3,) into b (3,)."""
    axis, cosine = cross(a, b), float(a @ b)
    sine = norm(axis)
    if sine > 1e-9:
        return exp(axis * (math.atan2(sine, cosine) / sine))
    if cosine > 0.0:
        return exp(vec(0.0, 0.0, 0.0))
    return exp(math.pi * across(a))  # opposite: any axis across a will do
