"""Notices that what a mission relies on does not arrive, or no longer does."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from missionkit.messages import Observation

FIX_INPUT, SCAN_INPUT, FLOW_INPUT, IMAGE_INPUT = "fix", "scan", "flow", "image"
EXTERNAL_INPUT = "external pose"
MISSING_AFTER = 3.0  # s
SAYS: Mapping[str, str] = {
    FIX_INPUT: "no usable satellite fix: the mission navigates by it",
    SCAN_INPUT: "no usable OBSTACLE_DISTANCE: the mission's avoidance sees nothing",
    FLOW_INPUT: "no usable optical flow: the mission navigates by it",
    EXTERNAL_INPUT: "no external pose: MAVLink brings none, only the simulator does",
    IMAGE_INPUT: "no camera image: the mission navigates by them",
}


class Reliance:
    """Watches what arrives.

    Args:
        inputs: what the mission relies on, of SAYS.
    """

    def __init__(self, inputs: Iterable[str]) -> None:
        self._inputs = tuple(inputs)
        self._since: dict[str, float] = {}  # s, when it came last, or the watch began
        self._missed: set[str] = set()

    def problems(self, seen: Observation) -> tuple[str, ...]:
        """Return what has been missing for MISSING_AFTER s, each time it goes missing."""
        came = {
            FIX_INPUT: seen.gnss,
            SCAN_INPUT: seen.scan,
            FLOW_INPUT: seen.flow,
            IMAGE_INPUT: seen.frame,
            EXTERNAL_INPUT: seen.external_pose,
        }
        new = []
        for name in self._inputs:
            if came[name] is not None:
                self._since[name] = seen.now
                self._missed.discard(name)
            since = self._since.setdefault(name, seen.now)
            if seen.now - since > MISSING_AFTER and name not in self._missed:
                self._missed.add(name)
                new.append(f"for {MISSING_AFTER:g} s {SAYS[name]}")
        return tuple(new)
