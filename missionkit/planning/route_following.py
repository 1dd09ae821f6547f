"""Following a route in space: straight legs, corners flown by or stopped at, braking ahead.

At a corner that turns by θ a vehicle that begins to turn d before it flies an arc of radius
R = d / tan(θ/2), so that its speed there is at most

    v_c = sqrt(a R),    and before it    v² = v_c² + 2 b s

with a and b the accelerations across and along the route and s the way that is left to the corner.
"""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

from missionkit.geometry import Vec3, vec
from missionkit.messages import Estimate

Triple = tuple[float, float, float]  # m, NED

LAG = 0.3  # s, by which the vehicle answers late
ACROSS, BRAKING = 1.5, 1.0  # m/s², a and b
CORNER_SPEED = 0.3  # m/s, through the sharpest corner
CLIMB, DESCENT = 2.0, 1.2  # m/s, of a steep leg
RESTING = 0.5  # m/s, that counts as stopped
INTERRUPTED, DISPLACED = 1.0, 1.0  # s without a step, and m off the route, after which it returns
RUN_IN = 3.0  # m, of what was flown already, that are flown again


class RoutePoint(NamedTuple):
    """A point of a route and how it is flown to and past."""

    position: Triple  # m, NED
    speed: float  # m/s, on the way to it
    stop: bool = False  # come to rest there
    radius: float = 2.0  # m, before the point, at which it may begin to turn
    within: float = 1.0  # m, that counts as having stopped at it


class Route(Protocol):
    """The points of a route, one at least; only those of the next legs are asked for."""

    def __len__(self) -> int:
        """Return how many there are."""

    def __getitem__(self, number: int, /) -> RoutePoint:
        """Return a point."""


class OnRoute(NamedTuple):
    """How far a route has been flown."""

    start: Triple  # m, NED, where it began
    at: float  # s, of the last step
    leg: int = 0  # the point that it is flying to
    along: float = 0.0  # m, on the way there
    returning: bool = False  # to where it was interrupted


class Followed(NamedTuple):
    """One step along a route."""

    position: Vec3  # (3,), m, NED, to be at
    velocity: Vec3 | None  # (3,), m/s, NED, of that place
    speed: float  # m/s, not to be exceeded
    course: float | None  # rad, of the leg; None: it is vertical
    on: OnRoute
    reached: int | None = None  # the point that it has just got to


class _Leg(NamedTuple):
    start: Triple
    end: RoutePoint
    length: float  # m
    way: Triple  # unit vector

    def at(self, along: float) -> Triple:
        (a, b, c), (n, e, d) = self.start, self.way
        return a + along * n, b + along * e, c + along * d

    @property
    def speed(self) -> float:
        """Speed (m/s) at which neither the climb nor the descent is too steep."""
        steep = CLIMB if self.way[2] < 0.0 else DESCENT
        slope = abs(self.way[2])
        return min(self.end.speed, steep / slope) if slope > 0.0 else self.end.speed


def unflown(last: float, now: float) -> float:
    """Return how long (s) no step was taken, 0.0 if the flight was not interrupted.

    Args:
        last: s, of the last step.
        now: s, of this one.
    """
    return now - last if now - last > INTERRUPTED else 0.0


def absent(last: float, now: float, off: float, *, returning: bool) -> tuple[float, bool]:
    """Return how long (s) since the last step does not count, and whether the vehicle returns.

    For what takes time at a place: neither an interruption nor the way back counts.

    Args:
        last: s, of the last step.
        now: s, of this one.
        off: m, from where the vehicle should be.
        returning: whether it was on its way back at the last step.
    """
    gap = unflown(last, now)
    if (returning or gap) and off > DISPLACED:
        return now - last, True
    return gap, False


def follow(route: Route, on: OnRoute, seen: Estimate) -> Followed:
    """Return where to be, how fast, and how far the route has been flown.

    A vehicle that was kept from following it, and is elsewhere by then, first returns to where it
    was interrupted.

    Args:
        route: its points, one at least.
        on: how far it was flown at the last step.
        seen: the estimate at this tick.
    """
    here: Triple = tuple(seen.position.tolist())
    leg = _leg(route, on)
    gap = unflown(on.at, seen.now)
    on = on._replace(at=seen.now)
    if gap and math.dist(here, leg.at(on.along)) > DISPLACED:
        on = on._replace(returning=True, along=max(0.0, on.along - RUN_IN))
    if on.returning:
        back = leg.at(on.along)
        if math.dist(here, back) > DISPLACED:
            return Followed(vec(*back), None, leg.speed, _course(leg), on)
        on = on._replace(returning=False)
    projected = sum((h - s) * w for h, s, w in zip(here, leg.start, leg.way, strict=True))
    on = on._replace(along=min(leg.length, max(on.along, projected)))
    if _passed(route, on, leg, here, seen):
        last = on.leg + 1 >= len(route)
        after = on if last else on._replace(leg=on.leg + 1, along=0.0)
        return _towards(route, after)._replace(reached=on.leg)
    return _towards(route, on)


def time_of(route: Route, start: Triple) -> float:
    """Return about how long (s) a route takes from `start`, its corners as braking allows."""
    total, leg = 0.0, 0
    entry = 0.0
    for leg in range(len(route)):
        it = _leg(route, OnRoute(start, 0.0, leg))
        leaves = _corner(route, OnRoute(start, 0.0, leg), it).speed
        total += _ramp(it.length, entry, it.speed, leaves)
        entry = leaves
    return total


def _ramp(length: float, entry: float, top: float, leaves: float) -> float:
    """Return the time (s) over a length with speeds at both ends, at most `top` between them."""
    peak = min(top, math.sqrt(max(0.0, BRAKING * length + 0.5 * (entry**2 + leaves**2))))
    peak = max(peak, CORNER_SPEED)
    ramps = max(0.0, peak - entry) / BRAKING + max(0.0, peak - leaves) / BRAKING
    flown = (max(0.0, peak**2 - entry**2) + max(0.0, peak**2 - leaves**2)) / (2.0 * BRAKING)
    return ramps + max(0.0, length - flown) / peak


def _leg(route: Route, on: OnRoute) -> _Leg:
    start = on.start if on.leg == 0 else route[on.leg - 1].position
    end = route[on.leg]
    length = math.dist(start, end.position)
    if length == 0.0:
        return _Leg(start, end, 0.0, (0.0, 0.0, 0.0))
    n, e, d = ((b - a) / length for a, b in zip(start, end.position, strict=True))
    return _Leg(start, end, length, (n, e, d))


class _Corner(NamedTuple):
    speed: float  # m/s
    lead: float  # m, before the point, at which it turns


def _corner(route: Route, on: OnRoute, leg: _Leg) -> _Corner:
    """Return how the end of a leg is flown past."""
    if leg.end.stop or on.leg + 1 >= len(route):
        return _Corner(0.0, 0.0)
    after = _leg(route, on._replace(leg=on.leg + 1))
    top = min(leg.speed, after.speed)
    if leg.length == 0.0 or after.length == 0.0:
        return _Corner(top, 0.0)
    cosine = sum(a * b for a, b in zip(leg.way, after.way, strict=True))
    half = 0.5 * math.acos(min(1.0, max(-1.0, cosine)))
    room = min(leg.end.radius, 0.5 * leg.length, 0.5 * after.length)
    bend = math.tan(min(half, 1.57))
    if bend < 1e-3:
        return _Corner(top, 0.0)
    speed = min(top, max(CORNER_SPEED, math.sqrt(ACROSS * room / bend)))
    return _Corner(speed, min(room, speed * speed * bend / ACROSS + LAG * speed))


def _passed(route: Route, on: OnRoute, leg: _Leg, here: Triple, seen: Estimate) -> bool:
    """Say whether the end of a leg has been got to."""
    if leg.end.stop or on.leg + 1 >= len(route):
        speed = math.hypot(*seen.velocity.tolist())
        return math.dist(here, leg.end.position) <= leg.end.within and speed < RESTING
    return on.along >= leg.length - _corner(route, on, leg).lead - 1e-6


def _towards(route: Route, on: OnRoute) -> Followed:
    leg = _leg(route, on)
    left = leg.length - on.along
    speed = _allowed(route, on, leg)
    corner = _corner(route, on, leg)
    ends = corner.speed == 0.0
    if ends and left <= speed * speed / (2.0 * BRAKING) + LAG * speed:
        end = vec(*leg.end.position)
        return Followed(end, None, max(speed, CORNER_SPEED), _course(leg), on)
    velocity = vec(*leg.way) * speed
    return Followed(vec(*leg.at(on.along)), velocity, leg.speed, _course(leg), on)


def _allowed(route: Route, on: OnRoute, leg: _Leg) -> float:
    """Return the speed (m/s) from which every corner ahead is met slowly enough."""
    top = leg.speed
    speed, at, ahead = top, on, leg.length - on.along - LAG * top
    while True:
        corner = _corner(route, at, leg)
        left = max(0.0, ahead - corner.lead)
        speed = min(speed, math.sqrt(corner.speed**2 + 2.0 * BRAKING * left))
        if corner.speed == 0.0 or 2.0 * BRAKING * left >= top * top:
            return max(speed, CORNER_SPEED)
        at = at._replace(leg=at.leg + 1, along=0.0)
        leg = _leg(route, at)
        ahead += leg.length


def _course(leg: _Leg) -> float | None:
    north, east, _ = leg.way
    return math.atan2(east, north) if math.hypot(north, east) * leg.length > RESTING else None
