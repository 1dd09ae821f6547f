"""Flights with as many states and transitions as a test asks for."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import vec
from missionkit.messages import Fired, Goal
from missionkit.recorder import flight_track as tracks
from missionkit.recorder.flight_track import FlightTrack, Span, Visit
from missionkit.recorder.scenery import DrawnMarker, DrawnTarget, Fence, Round, Scenery

REASONS = (
    "when done",
    "when marker-sure and trunk-in-range and near-goal",
    "failsafe battery: battery below (floor 0.2) for 3 s, or unknown for 2 s and still so after it",
    "after 20 s",
)
SOUTH = np.array([0.5, -0.5, -0.5, 0.5])  # a marker whose normal points south


def poles(count: int, north: float, east: float, seed: int = 0) -> Scenery:
    """Poles with a marker each, every one a target, inside a fence."""
    rng = np.random.default_rng(seed)
    spots = [
        (float(rng.uniform(0.1, 1.0) * north), float(rng.uniform(-0.5, 0.5) * east))
        for _ in range(count)
    ]
    return Scenery(
        tuple(Round((n + 0.5, e), 0.4, 0.0, 5.0) for n, e in spots),
        tuple(
            DrawnMarker(f"marker {k}", vec(n, e, -2.0), SOUTH, 0.4)
            for k, (n, e) in enumerate(spots)
        ),
        tuple(DrawnTarget(f"pole-{k}", spot) for k, spot in enumerate(spots)),
        (Fence.box((-15.0, north + 15.0), (-0.5 * east - 15.0, 0.5 * east + 15.0)),),
    )


def flight(states: int, transitions: int, scenery: Scenery, seed: int = 0) -> FlightTrack:
    """Fly from pole to pole, through every state at least once, back to some of them often."""
    rng = np.random.default_rng(seed)
    work = ("approach", "servo", "inject")
    inner = [f"pole-{k // 3}/{work[k % 3]}" for k in range(states - 2)]
    names = ["idle", *inner, "land"]
    order = [0]
    while len(order) < transitions:
        known = len(order) >= states - 1
        order.append(int(rng.integers(1, states - 1)) if known else len(order))
    track, here, now = tracks.begin(), np.zeros(3), 0.0
    for leg, state in enumerate([*order, states - 1]):
        pole = scenery.targets[(max(state - 1, 0) // 3) % len(scenery.targets)]
        inside = 0 < state < states - 1
        goal = np.array([*pole.at, -3.0]) if inside else here * (1, 1, 0) + (0, 0, -5.0 * (not leg))
        lasts = max(float(np.linalg.norm(goal - here)) / 3.0, 1.5)
        for k in range(round(lasts * 10.0)):
            share = 0.5 - 0.5 * math.cos(math.pi * k / round(lasts * 10.0))
            place = here + share * (goal - here)
            track.times.append(now + 0.1 * k)
            track.true.append(tuple(place.tolist()))
            track.estimated.append(tuple((place + rng.normal(0.0, 0.05, 3)).tolist()))
        track.visits.append(Visit(names[state], now, now + lasts))
        now, here = now + lasts, goal + rng.normal(0.0, 0.05, 3)
        if inside:
            track.goals.append(Goal(vec(*goal), 0.0, now - 0.1, pole.name))
        if leg < len(order):
            to = names[[*order, states - 1][leg + 1]]
            track.transitions.append((now, Fired(names[state], to, REASONS[leg % 4], (), ())))
    for k in range(min(5 + states, 40)):
        ends = np.cumsum(rng.exponential(now / (3 + k), 60 + k))
        edges = [0.0, *ends[ends < now].tolist(), now]
        said = [(True, False, None)[int(it)] for it in rng.integers(3, size=len(edges))]
        track.guards[f"guard-{k} of (target pole-{k}, longer_than {k})"] = [
            Span(a, b, holds) for a, b, holds in zip(edges, edges[1:], said, strict=False)
        ]
    return track
