"""More markers of one id in view than the mission has: the target's own is told apart, or none."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from missionkit.geometry import norm
from missionkit.messages import Detection, Sighting, Target
from missionkit.perception.marker_selection import GATE_SIGMAS, Candidate

APART: Final = 0.5  # of a marker's side: two readings of one marker have nearly the same centre
EPISODE_ENDS: Final = 5.0  # s without duplicates

MarkerId = tuple[str, int]  # dictionary and id


class DuplicateMarkers(NamedTuple):
    """An episode in which a target's marker had a duplicate in view."""

    target: str
    marker: MarkerId
    in_view: int  # markers, when it began
    declared: int  # markers of this id in the mission
    used: bool  # one of them was taken for the target's
    since: float  # s, first frame
    last: float  # s, latest frame

    def message(self) -> str:
        """Say what is in view and what becomes of it, in a sentence."""
        name, number = self.marker
        fate = (
            f"the one where {self.target} is expected is used"
            if self.used
            else f"none is used, because it is not clear which belongs to {self.target}"
        )
        return (
            f"{self.in_view} markers with id {number} ({name}) are in view, but the mission has "
            f"{self.declared}: {fate}; remove or cover the others"
        )


def distinct(detections: Iterable[Detection]) -> list[Detection]:
    """Return the detections whose centres lie more than half a side apart, largest first."""
    kept: list[Detection] = []
    for it in sorted({id(it): it for it in detections}.values(), key=lambda it: -it.area):
        if all(_apart(it, other) for other in kept):
            kept.append(it)
    return kept


def _apart(one: Detection, larger: Detection) -> bool:
    gap = np.asarray(one.corners.mean(axis=0) - larger.corners.mean(axis=0))
    return math.hypot(*gap.tolist()) > APART * math.sqrt(larger.area)


def told_apart(
    found: Mapping[str, Sequence[Candidate]],
    sightings: Sequence[Sighting],
    declared: Mapping[MarkerId, int],
    targets: Mapping[str, Target],
) -> tuple[dict[str, list[Candidate]], list[DuplicateMarkers]]:
    """Return the candidates without those that cannot be told apart, and what was in view twice.

    Args:
        found: plausible candidates by target.
        sightings: of all markers in one frame.
        declared: markers in the mission, by id.
        targets: beliefs about them.
    """
    counts = _surplus(sightings, declared)
    kept, episodes = {name: list(each) for name, each in found.items()}, []
    for target, marker in sorted({(it.target, _marker(it)) for it in sightings}):
        if marker not in counts:
            continue
        equal = [it for it in kept.get(target, []) if _marker(it.sighting) == marker]
        own = _identified(equal, targets.get(target))
        others = [it for it in kept.get(target, []) if _marker(it.sighting) != marker]
        kept[target] = [*others, *own]
        at, many = sightings[0].at, (counts[marker], declared[marker])
        episodes.append(DuplicateMarkers(target, marker, *many, bool(own), at, at))
    return {name: each for name, each in kept.items() if each}, episodes


def _surplus(
    sightings: Iterable[Sighting], declared: Mapping[MarkerId, int]
) -> dict[MarkerId, int]:
    """Return how many markers of an id are in view, where they are more than `declared`."""
    groups: dict[MarkerId, list[Detection]] = {}
    for it in sightings:
        groups.setdefault(_marker(it), []).append(it.detection)
    counts = {marker: len(distinct(group)) for marker, group in groups.items()}
    return {marker: count for marker, count in counts.items() if count > declared[marker]}


def _marker(sighting: Sighting) -> MarkerId:
    return sighting.detection.dictionary, sighting.detection.id


def _identified(candidates: Sequence[Candidate], prior: Target | None) -> list[Candidate]:
    """Return those of one id that can be the target's own marker; none if several can.

    A target that the camera has not seen yet may be wherever its survey allows: of several
    candidates none is taken. Once it has been seen, its own marker is the only one within five
    standard deviations of the estimate, without the allowance for a poor survey.
    """
    if _single(candidates):
        return list(candidates)
    if prior is None or prior.seen_at is None:
        return []
    near = [it for it in candidates if _is_expected(it, prior)]
    return near if _single(near) else []


def _single(candidates: Sequence[Candidate]) -> bool:
    return len(distinct(it.sighting.detection for it in candidates)) == 1


def _is_expected(candidate: Candidate, prior: Target) -> bool:
    if candidate.position is None:
        return False
    sd = math.hypot(prior.position_sd, candidate.sighting.position_sd)
    return norm(candidate.position - prior.position) <= GATE_SIGMAS * sd


def continued(
    episodes: Iterable[DuplicateMarkers], seen: Iterable[DuplicateMarkers], at: float
) -> tuple[DuplicateMarkers, ...]:
    """Return the episodes after a frame at time `at` (s); those that have ended are dropped.

    Args:
        episodes: of the frames before.
        seen: duplicates in this frame.
        at: s, exposure of the frame, not before the last.
    """
    known = {_kind(it): it for it in episodes if at - it.last <= EPISODE_ENDS}
    for it in seen:
        before = known.get(_kind(it), it)
        known[_kind(it)] = before._replace(last=at)
    return tuple(known.values())


def _kind(episode: DuplicateMarkers) -> tuple[str, MarkerId, bool]:
    return episode.target, episode.marker, episode.used


def begun(
    now: Iterable[DuplicateMarkers], before: Iterable[DuplicateMarkers]
) -> tuple[DuplicateMarkers, ...]:
    """Return the episodes that were not there `before`."""
    known = {(*_kind(it), it.since) for it in before}
    return tuple(it for it in now if (*_kind(it), it.since) not in known)
