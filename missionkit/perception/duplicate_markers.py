"""Duplicates: more markers of one id in view than the mission has; only a clear match is used."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import numpy as np

from missionkit.geometry import norm
from missionkit.messages import MARKER_DUPLICATED, Detection, Sighting, Target
from missionkit.perception.marker_selection import GATE_SIGMAS, Candidate
from missionkit.perception.vision_warning import VisionWarning

APART: Final = 0.5  # of a marker's side: two readings of one marker have nearly the same centre
MarkerId = tuple[str, int]  # dictionary and id


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


def without_duplicates(
    found: Mapping[str, Sequence[Candidate]],
    sightings: Sequence[Sighting],
    declared: Mapping[MarkerId, int],
    targets: Mapping[str, Target],
) -> tuple[dict[str, list[Candidate]], list[VisionWarning]]:
    """Return the candidates without those that cannot be told apart, and a warning of duplicates.

    Args:
        found: plausible candidates by target.
        sightings: of all markers in one frame.
        declared: markers in the mission, by id.
        targets: beliefs about them.
    """
    counts = _surplus(sightings, declared)
    kept, warnings = {name: list(each) for name, each in found.items()}, []
    for target, marker in sorted({(it.target, _marker(it)) for it in sightings}):
        if marker not in counts:
            continue
        equal = [it for it in kept.get(target, []) if _marker(it.sighting) == marker]
        own = _identified(equal, targets.get(target))
        others = [it for it in kept.get(target, []) if _marker(it.sighting) != marker]
        kept[target] = [*others, *own]
        counted = counts[marker], declared[marker]
        warnings.append(_warning(sightings[0].at, target, marker, counted, used=bool(own)))
    return {name: each for name, each in kept.items() if each}, warnings


def _warning(
    at: float, target: str, marker: MarkerId, counted: tuple[int, int], *, used: bool
) -> VisionWarning:
    name, number = marker
    in_view, wanted = counted
    fate = (
        f"the one where {target} is expected is used"
        if used
        else f"none is used, because it is not clear which belongs to {target}"
    )
    message = (
        f"{in_view} markers with id {number} ({name}) are in view, but the mission has {wanted}: "
        f"{fate}; remove or cover the others"
    )
    about = (target, name, str(number), "used" if used else "unused")
    return VisionWarning(MARKER_DUPLICATED, about, message, at, at)


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
