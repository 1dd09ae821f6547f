"""One chain of frames, each transform with its time: world <- odom <- base <- camera.

Source: P1 section 9.3; the chain is a tree, so markers hang below the world in the same way.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from missionkit.errors import MissionkitError, nearest
from missionkit.geometry import (
    IDENTITY,
    Transform,
    conjugate,
    exp,
    log,
    multiply,
    normalised,
    vec,
)

FROM_THE_START = float("-inf")
NO_MOTION = Transform(IDENTITY, vec(0.0, 0.0, 0.0))


class FrameError(MissionkitError):
    """A frame that does not exist, or a time for which its pose is not known."""


class Timed(NamedTuple):
    """A transform and when it was valid."""

    at: float  # s
    transform: Transform


class Edge(NamedTuple):
    """Poses of one frame in its parent, oldest first."""

    parent: str
    poses: tuple[Timed, ...]  # frame to parent
    held: bool = False  # each pose holds until the next one, instead of being interpolated


def between(before: Timed, after: Timed, at: float) -> Transform:
    """Move from one pose to another at constant velocity and turn rate.

    T(u) = (q_0 ⊗ Exp(u Log(q_0* ⊗ q_1)), (1 - u) t_0 + u t_1); u leaves [0, 1] to extrapolate.
    Source: Solà 2017, section 2.7 (slerp).

    Args:
        before: pose and time (s).
        after: pose and time (s), later.
        at: s.
    """
    a, b = before.transform, after.transform
    share = (at - before.at) / (after.at - before.at)
    turn = log(multiply(conjugate(a.rotation), b.rotation))
    return Transform(
        normalised(multiply(a.rotation, exp(share * turn))),
        a.translation + share * (b.translation - a.translation),
    )


def interpolate(poses: Sequence[Timed], at: float) -> Transform | None:
    """Return the pose at time `at` (s), None outside the times of `poses` (oldest first)."""
    if not poses or not poses[0].at <= at <= poses[-1].at:
        return None
    after = bisect_right(poses, at, key=lambda pose: pose.at)
    if after == len(poses):
        return poses[-1].transform
    return between(poses[after - 1], poses[after], at)


def held(poses: Sequence[Timed], at: float) -> Transform | None:
    """Return the last of `poses` (oldest first) that is not after `at` (s), None before all."""
    after = bisect_right(poses, at, key=lambda pose: pose.at)
    return poses[after - 1].transform if after else None


@dataclass(frozen=True, slots=True)
class FrameTree:
    """Frames below `root`, each with its poses in its parent over time."""

    root: str = "world"
    edges: Mapping[str, Edge] = field(default_factory=dict)

    def moving(self, frame: str, parent: str, poses: Sequence[Timed]) -> FrameTree:
        """Return the tree with `frame` added, interpolated between `poses` (oldest first).

        Args:
            frame: name, not in the tree yet.
            parent: name of a frame in the tree.
            poses: frame to parent, with times (s).
        """
        return self._with(frame, Edge(parent, tuple(poses)))

    def stepping(self, frame: str, parent: str, poses: Sequence[Timed]) -> FrameTree:
        """Return the tree with `frame` added, which stays at each of `poses` until the next.

        Args:
            frame: name, not in the tree yet.
            parent: name of a frame in the tree.
            poses: frame to parent, with times (s).
        """
        return self._with(frame, Edge(parent, tuple(poses), held=True))

    def fixed(self, frame: str, parent: str, pose: Transform) -> FrameTree:
        """Return the tree with `frame` added, for ever at `pose` (frame to parent).

        Args:
            frame: not in the tree yet.
            parent: in the tree.
            pose: from `frame` to `parent`, m.

        Raises:
            FrameError: `parent` is not in the tree, or `frame` is already.
        """
        return self._with(frame, Edge(parent, (Timed(FROM_THE_START, pose),), held=True))

    def lookup(self, target: str, source: str, at: float) -> Transform:
        """Return T_target_source, which maps coordinates in `source` to `target`, at time `at`.

        Args:
            target: frame of the result.
            source: frame of the input.
            at: s.

        Raises:
            FrameError: a frame is unknown, or a pose between the two is not known at that time.
        """
        ours, theirs = self._path(target), self._path(source)
        meeting = next(frame for frame in ours if frame in theirs)
        return self._up(target, meeting, at).inverse() @ self._up(source, meeting, at)

    def _with(self, frame: str, edge: Edge) -> FrameTree:
        self._check(edge.parent)
        if frame == self.root or frame in self.edges:
            raise FrameError(f"frame {frame!r} is already in the tree")
        return FrameTree(self.root, {**self.edges, frame: edge})

    def _check(self, frame: str) -> None:
        if frame != self.root and frame not in self.edges:
            raise FrameError(f"no frame {frame!r}; {nearest(frame, [self.root, *self.edges])}")

    def _path(self, frame: str) -> list[str]:
        self._check(frame)
        path = [frame]
        while path[-1] != self.root:
            path.append(self.edges[path[-1]].parent)
        return path

    def _up(self, frame: str, ancestor: str, at: float) -> Transform:
        if frame == ancestor:
            return NO_MOTION
        edge = self.edges[frame]
        pose = held(edge.poses, at) if edge.held else interpolate(edge.poses, at)
        if pose is None:
            raise FrameError(f"frame {frame!r} is not known at {at:.3f} s, {_span(edge.poses)}")
        return self._up(edge.parent, ancestor, at) @ pose


def _span(poses: Sequence[Timed]) -> str:
    if not poses:
        return "nor at any time"
    return f"only from {poses[0].at:.3f} s to {poses[-1].at:.3f} s"
