"""Geometry of docking: the faces of a cube, the docked pose and the docking corridor.

Faces are named by body axes: front +x, back -x, right +y, left -y, bottom +z, top -z. A chaser
docks with its bottom, where its camera is, so its z axis then points into the target's face:

    q_docked = q_target ⊗ q_face(roll),  p_docked = p_target + (a + b) n      q_face: e_z -> -n

with n the face's outward normal and a, b half the sides of the cubes. For the top face q_face is
the identity: the docked chaser has the attitude of the target, as P3's reorientation wants it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal, NamedTuple

from missionkit.geometry import (
    Quat,
    Transform,
    Vec3,
    conjugate,
    exp,
    log,
    multiply,
    norm,
    normalised,
    rotate,
    vec,
)

Face = Literal["front", "back", "right", "left", "bottom", "top"]

NORMALS: Mapping[Face, tuple[float, float, float]] = {
    "front": (1.0, 0.0, 0.0),
    "back": (-1.0, 0.0, 0.0),
    "right": (0.0, 1.0, 0.0),
    "left": (0.0, -1.0, 0.0),
    "bottom": (0.0, 0.0, 1.0),
    "top": (0.0, 0.0, -1.0),
}
"""Outward normals in body axes."""

_TURNS: Mapping[Face, tuple[float, float, float]] = {
    "front": (0.0, -0.5, 0.0),
    "back": (0.0, 0.5, 0.0),
    "right": (0.5, 0.0, 0.0),
    "left": (-0.5, 0.0, 0.0),
    "bottom": (1.0, 0.0, 0.0),
    "top": (0.0, 0.0, 0.0),
}
"""Rotation vectors (half turns) of q_face without roll: the shortest turn of e_z to -n."""


def turned(angles_deg: tuple[float, float, float]) -> Quat:
    """Return R_x(a) R_y(b) R_z(c), (4,): a turn about x, then the new y, then the new z (deg).

    P3 gives (-90, 0, -90) without an order. In this one a target's x, y, z axes point along the
    mother-ship's z, x, y: its top face looks to -y, to the chaser (near side), its bottom away.
    """
    a, b, c = map(math.radians, angles_deg)
    about_x, about_y, about_z = exp(vec(a, 0.0, 0.0)), exp(vec(0.0, b, 0.0)), exp(vec(0.0, 0.0, c))
    return normalised(multiply(about_x, multiply(about_y, about_z)))


def face_rotation(face: Face, roll_deg: float = 0.0) -> Quat:
    """Return the attitude (4,) of a chaser docked to a face, in the target's axes.

    Args:
        face: of the target.
        roll_deg: turn about the docking axis.
    """
    turn = exp(math.pi * vec(*_TURNS[face]))
    return multiply(turn, exp(vec(0.0, 0.0, math.radians(roll_deg))))


class Berth(NamedTuple):
    """Where a chaser docks, in the mother-ship's frame."""

    pose: Transform  # of the docked chaser, body to mother-ship
    normal: Vec3  # (3,), unit, out of the target's docking face


class Corridor(NamedTuple):
    """The docking corridor: a blunt cone before the docked place, wider with distance."""

    radius: float  # m, at the docked place
    slope: float  # tangent of the cone's half-angle
    length: float  # m, from the docked place
    depth: float  # m, that the chaser may be too close

    def sideways(self, berth: Berth, position: Vec3) -> float | None:
        """Return the distance (m) of a place from the docking axis, None outside the corridor."""
        offset = position - berth.pose.translation
        along = float(offset @ berth.normal)
        across = offset - along * berth.normal
        aside = math.sqrt(float(across @ across))
        wide = self.radius + self.slope * max(0.0, along)
        return aside if -self.depth <= along <= self.length and aside <= wide else None


def berth_at(
    target: Transform, face: Face, roll_deg: float, target_size: float, chaser_size: float
) -> Berth:
    """Return where a chaser docks.

    Args:
        target: its pose, body to mother-ship.
        face: of the target.
        roll_deg: of the docked chaser about the docking axis.
        target_size: side of the target's cube (m).
        chaser_size: side of the chaser's cube (m).
    """
    normal = rotate(target.rotation, vec(*NORMALS[face]))
    place = target.translation + 0.5 * (target_size + chaser_size) * normal
    attitude = normalised(multiply(target.rotation, face_rotation(face, roll_deg)))
    return Berth(Transform(attitude, place), normal)


def pose_error(berth: Berth, position: Vec3, attitude: Quat) -> tuple[float, float]:
    """Return how far a chaser is from being docked: m of its centre, rad of the turn left.

    Args:
        berth: where it docks.
        position: (3,), m.
        attitude: (4,), body to mother-ship.
    """
    left = multiply(conjugate(berth.pose.rotation), attitude)
    return norm(position - berth.pose.translation), norm(log(left))
