"""A fitted plan as the text of a mission file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise

from missionkit.interchange.plan import (
    Action,
    Corridor,
    Fence,
    Land,
    LatLon,
    Place,
    Plan,
    Return,
    Survey,
    TakeOff,
    Turns,
    Waypoint,
)

MOST_PLACES = 1_000  # of one state
CAMERA = "camera"  # the payload of surveys and photographs
RALLY, LOOK, TURNS = "rally", "look", "turns"  # names of targets
LANDING_PLACE = "landing-place"
HOME, GROUND = "home", "land"  # names of states
_FAILSAFES = (
    "  - {name: battery, when: {use: battery_below, floor: 0.25}, to: home}",
    "  - {name: link, when: {use: link_lost, longer_than: 3}, to: home}",
    "  - {name: lost, when: estimate_bad, for: 1, to: land}",
)
_FENCE_FAILSAFE = "  - {name: fence, when: {not: inside_fence}, to: home}"


def mission_text(plan: Plan, name: str) -> str:
    """Return a mission that flies a plan, one state after the other.

    Args:
        plan: as `fit` returns it.
        name: of the mission; what names cannot have becomes a hyphen.
    """
    targets = _Targets(plan)
    states = list(_states(plan.actions, targets))
    lines = [
        "missionkit: 1",
        f"mission: {mission_name(name)}",
        *_origin(plan),
        *targets.lines(),
        *([] if plan.fence is None else _fence(plan.fence)),
        "failsafes:",
        *_FAILSAFES,
        *([] if plan.fence is None else [_FENCE_FAILSAFE]),
        f"initial: {states[0][0]}",
        "states:",
    ]
    for (state, kind, behavior), (after, *_) in pairwise(states):
        lines += _state(state, kind, behavior, after)
    if all(state != HOME for state, *_ in states):
        lines += _state(HOME, "return", ["{use: go_to, target: home}"], GROUND)
    return "\n".join([*lines, f"  {GROUND}: {{kind: land}}", ""])


def mission_name(text: str) -> str:
    """Return the name of a mission that comes nearest to a text.

    >>> mission_name("Feld 7 (Süd).plan"), mission_name("7")
    ('Feld-7-S-d-plan', 'imported-7')
    """
    name = re.sub(r"[^A-Za-z0-9_]+", "-", text).strip("-_")[:60]
    return name if re.match(r"[A-Za-z]", name) else f"imported-{name}".rstrip("-")


def figure(value: float) -> str:
    """Return a number as YAML reads it back, without an exponent.

    >>> figure(47.0), figure(0.000001), figure(-0.0)
    ('47', '0.000001', '0')
    """
    text = f"{value + 0.0:.9f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


class _Targets:
    """The places that have names: rally points, what is looked at and flown round."""

    def __init__(self, plan: Plan) -> None:
        looks = [it.look_at for it in plan.actions if isinstance(it, Waypoint) and it.look_at]
        turns = [it.place for it in plan.actions if isinstance(it, Turns)]
        self.names: dict[tuple[str, Place], str] = {}
        for prefix, places in (
            (RALLY, [it.place for it in plan.rally]),
            (LOOK, looks),
            (TURNS, turns),
        ):
            for count, place in enumerate(dict.fromkeys(places), 1):
                self.names[prefix, place] = f"{prefix}-{count}"

    def lines(self) -> Iterator[str]:
        """Yield the section `targets`."""
        if self.names:
            yield "targets:"
        for (_, place), name in self.names.items():
            yield f"  {name}: {{position: {_place(place)}}}"


def _origin(plan: Plan) -> Iterator[str]:
    if plan.home is not None:
        lat, lon, alt = map(figure, plan.home)
        yield f"origin: {{lat: {lat}, lon: {lon}, alt: {alt}}}"


def _fence(fence: Fence) -> Iterator[str]:
    yield "fence:"
    yield f"  polygon: {_spots(fence.outline)}"
    if fence.holes:
        yield "  holes:"
        yield from (f"    - {_spots(corners)}" for corners, _ in fence.holes)
    if fence.height is not None:
        yield f"  height: {figure(fence.height)}"


def _state(name: str, kind: str, behavior: Sequence[str], after: str) -> Iterator[str]:
    yield f"  {name}:"
    yield f"    kind: {kind}"
    if len(behavior) == 1:
        yield f"    behavior: {behavior[0]}"
    else:
        yield "    behavior:"
        yield from (f"      {line}" for line in behavior)
    yield f"    transitions: [{{to: {after}, when: done}}]"


def _states(
    actions: Sequence[Action], targets: _Targets
) -> Iterator[tuple[str, str, Sequence[str]]]:
    """Yield name, kind and behaviour of each state; the last is on the ground."""
    counts: dict[str, int] = {}
    for kind, group in groupby(actions, type):
        same = list(group)
        if kind is Waypoint:
            for start in range(0, len(same), MOST_PLACES):
                part = [it for it in same[start : start + MOST_PLACES] if isinstance(it, Waypoint)]
                yield _numbered(counts, "route"), "custom", list(_route(part, targets))
            continue
        for action in same:
            yield from _single(action, counts, targets)
    yield GROUND, "land", ()


def _numbered(counts: dict[str, int], prefix: str) -> str:
    counts[prefix] = counts.get(prefix, 0) + 1
    return f"{prefix}-{counts[prefix]}"


def _single(
    action: Action, counts: dict[str, int], targets: _Targets
) -> Iterator[tuple[str, str, Sequence[str]]]:
    match action:
        case TakeOff():
            yield "take-off", "idle", [f"{{use: take_off, height: {figure(action.height)}}}"]
        case Turns():
            yield _numbered(counts, "circle"), "custom", [_orbit(action, targets)]
        case Survey() | Corridor():
            name = "survey" if isinstance(action, Survey) else "corridor"
            yield _numbered(counts, name), "custom", list(_lines(action))
        case Land(spot=LatLon()):
            yield LANDING_PLACE, "custom", [f"{{use: waypoints, places: [{_spot(action.spot)}]}}"]
        case Return():
            yield HOME, "return", ["{use: go_to, target: home}"]
        case _:
            pass


def _orbit(action: Turns, targets: _Targets) -> str:
    turning = "" if action.clockwise else ", clockwise: false"
    place = action.place
    height = f", height: {figure(place.height)}"
    return (
        f"{{use: orbit, target: {targets.names[TURNS, place]}, radius: {figure(action.radius)}, "
        f"turns: {figure(action.turns)}{height}, speed: {figure(action.speed or 0.0)}{turning}}}"
    )


def _lines(action: Survey | Corridor) -> Iterator[str]:
    if isinstance(action, Survey):
        yield "use: survey"
        yield f"polygon: {_spots(action.polygon)}"
        if action.angle is not None:
            yield f"angle_deg: {figure(action.angle)}"
    else:
        yield "use: corridor"
        yield f"line: {_spots(action.line)}"
        yield f"breadth: {figure(action.breadth)}"
    yield f"height: {figure(action.height)}"
    yield f"spacing: {figure(action.spacing or 0.0)}"
    yield f"turn_around: {figure(action.turn_around)}"
    yield f"speed: {figure(action.speed or 0.0)}"
    yield f"payload: {CAMERA}"


def _route(places: Sequence[Waypoint], targets: _Targets) -> Iterator[str]:
    speed = places[0].speed or 0.0
    yield "use: waypoints"
    yield f"speed: {figure(speed)}"
    yield "places:"
    for it in places:
        more = list(_more(it, speed, targets))
        place = _place(it.place)
        yield f"  - {place}" if not more else f"  - {{at: {place}, {', '.join(more)}}}"


def _more(it: Waypoint, speed: float, targets: _Targets) -> Iterator[str]:
    if it.speed is not None and it.speed != speed:
        yield f"speed: {figure(it.speed)}"
    if it.heading is not None:
        yield f"heading_deg: {figure(it.heading)}"
    if it.look_at is not None:
        yield f"look_at: {targets.names[LOOK, it.look_at]}"
    if it.stop:
        yield "stop: true"
    if it.wait > 0.0:
        yield f"wait: {figure(it.wait)}"
    if it.photo:
        yield f"payload: {CAMERA}"


def _place(place: Place) -> str:
    lat, lon, height = map(figure, place[:3])
    return f"{{lat: {lat}, lon: {lon}, {place.reference}: {height}}}"


def _spot(spot: LatLon | None) -> str:
    return "" if spot is None else f"{{lat: {figure(spot.lat)}, lon: {figure(spot.lon)}}}"


def _spots(corners: Sequence[LatLon]) -> str:
    return f"[{', '.join(map(_spot, corners))}]"
