"""Circles, climbs, waits, turns of the nose, and following, against geometry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from flying import fly, places
from playing import marker
from pydantic import ValidationError

from missionkit.behaviors.climb import Climb
from missionkit.behaviors.follow import Follow
from missionkit.behaviors.loiter import Loiter
from missionkit.behaviors.orbit import Orbit
from missionkit.behaviors.point_at import PointAt
from missionkit.geometry import vec, wrap

TOWER = marker(20.0, 10.0, -8.0)


def about(target):
    return lambda _: {"tower": target}


def swept(at):
    angle = np.unwrap(np.arctan2(at[:, 1] - 10.0, at[:, 0] - 20.0))
    return angle - angle[0]


@pytest.mark.parametrize("clockwise", [True, False])
@pytest.mark.parametrize("start", [(0.0, 0.0, -8.0), (18.0, 10.0, -8.0)])
def test_an_orbit_is_a_circle_flown_its_number_of_turns_looking_inwards(clockwise, start):
    orbit = Orbit(target="tower", radius=6.0, speed=2.0, turns=1.5, clockwise=clockwise)
    flown = fly(orbit, start, 120.0, about(TOWER))
    assert flown[-1].step.done
    on = [it for it in flown if it.step.note.startswith("turn")][60:]
    at = places(on)
    radii = np.linalg.norm(at[:, :2] - (20, 10), axis=1)
    assert radii.min() > 5.5
    assert radii.max() < 6.5
    circle = places([it for it in flown if it.step.note.startswith("turn")])
    turned = swept(circle)[-1] / math.tau
    assert turned == pytest.approx(1.5 if clockwise else -1.5, abs=0.02)
    for seen, _ in on[60:]:
        north, east, _ = TOWER.position - seen.position
        assert abs(wrap(math.atan2(east, north) - seen.yaw)) < math.radians(6.0)
    speeds = np.linalg.norm(np.diff(at[:, :2], axis=0), axis=1) / 0.05
    assert np.median(speeds) == pytest.approx(2.0, rel=0.1)


def test_an_orbit_climbs_evenly_along_a_tower():
    orbit = Orbit(target="tower", radius=6.0, turns=3.0, height=5.0, to_height=20.0, look="course")
    flown = fly(orbit, (14.0, 10.0, -5.0), 200.0, about(TOWER))
    at = places(flown)
    turns = np.abs(swept(at)) / math.tau
    np.testing.assert_allclose(-at[60:, 2], 5.0 + 5.0 * turns[60:], atol=0.6)
    assert at[-1][2] == pytest.approx(-20.0, abs=0.6)
    way = np.array(orbit.way((14.0, 10.0, -5.0), {"tower": (20.0, 10.0, -8.0)}))
    np.testing.assert_allclose(np.linalg.norm(way[:, :2] - (20, 10), axis=1), 6.0)
    assert (way[0][2], way[-1][2]) == (-5.0, -20.0)


@pytest.mark.parametrize(("height", "to_height"), [(5.0, 35.0), (35.0, 5.0)])
def test_an_orbit_that_climbs_steeply_is_flown_as_fast_as_that_can_be(height, to_height):
    orbit = Orbit(target="tower", radius=4.0, turns=0.5, height=height, to_height=to_height)
    flown = fly(orbit, (36.0, 0.0, -height), 120.0, lambda _: {"tower": TOWER})
    assert flown[-1].step.done
    assert -flown[-1].seen.position[2] == pytest.approx(to_height, abs=1.0)
    sinking = [it.step.guidance.velocity[2] for it in flown if it.step.note.startswith("turn")]
    assert min(sinking) > -2.1
    assert max(sinking) < 1.3


def test_an_orbit_lasts_its_seconds_or_for_ever():
    flown = fly(
        Orbit(target="tower", radius=6.0, seconds=9.0), (14.0, 10.0, -8.0), 60.0, about(TOWER)
    )
    assert flown[-1].seen.now == pytest.approx(9.0, abs=0.1)
    assert Orbit(target="tower").endless
    assert not Orbit(target="tower", turns=1).endless
    fast = Orbit(target="tower", radius=1.0, speed=8.0)
    flown = fly(fast, (21.0, 10.0, -8.0), 20.0, about(TOWER))
    speeds = np.linalg.norm([it.seen.velocity for it in flown], axis=1)
    assert speeds.max() < 1.5  # v² / r <= 1.5 m/s²


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"turns": 1, "seconds": 3}, "either"),
        ({"to_height": 3}, "needs turns"),
        ({"turns": 0}, "greater than 0"),
    ],
)
def test_an_orbit_that_contradicts_itself_is_refused(wrong, says):
    with pytest.raises(ValidationError, match=says):
        Orbit(target="tower", **wrong)


def test_a_climb_is_straight_and_ends_at_its_height():
    flown = fly(Climb(height=20.0, speed=2.0), (3.0, 4.0, -6.0), 60.0)
    at = places(flown)
    assert flown[-1].step.done
    assert np.abs(at[:, :2] - (3, 4)).max() < 0.1
    assert at[-1][2] == pytest.approx(-20.0, abs=0.5)
    assert np.abs(np.diff(at[:, 2])).max() <= 2.0 * 0.05 + 1e-6
    assert fly(Climb(height=2.0), (3.0, 4.0, -6.0), 60.0)[-1].step.done


def test_a_wait_counts_from_when_the_vehicle_rests():
    flown = fly(Loiter(seconds=4.0, heading_deg=90.0), (3.0, 4.0, -6.0), 60.0)
    assert flown[-1].seen.now == pytest.approx(4.0, abs=0.06)
    assert flown[-1].seen.yaw == pytest.approx(math.pi / 2, abs=0.05)
    late = Loiter(seconds=4.0).begin(flown[0].seen)
    away = fly(Loiter(seconds=4.0), (13.0, 4.0, -6.0), 60.0, memory=late)
    assert away[-1].seen.now > 4.0 + 10.0 / 1.0


def test_the_nose_turns_to_a_target_and_the_vehicle_stays():
    flown = fly(PointAt(target="tower"), (0.0, 10.0, -6.0), 30.0, about(marker(0.0, -10.0, -8.0)))
    assert flown[-1].step.done
    assert flown[-1].seen.yaw == pytest.approx(-math.pi / 2, abs=math.radians(3.0))
    assert np.abs(places(flown) - (0, 10, -6)).max() < 0.1
    below = fly(PointAt(target="tower"), (20.0, 10.0, -16.0), 1.0, about(TOWER))
    assert below[-1].step.done
    assert fly(PointAt(target="tower"), (0, 0, -5), 0.1)[0].step.note == (
        "the position of tower is unknown"
    )


def moving(now, speed=2.0):
    """A target that drives north, then, after 20 s, east."""
    north, east = min(now, 20.0) * speed, max(0.0, now - 20.0) * speed
    way = vec(speed, 0.0, 0.0) if now < 20.0 else vec(0.0, speed, 0.0)
    return {"car": marker(north, east, 0.0, seen_at=now)._replace(velocity=way)}


@pytest.mark.parametrize(("side", "off"), [("behind", math.pi), ("ahead", 0.0), ("bearing", 0.5)])
def test_it_stays_on_its_side_of_a_target_that_moves_and_looks_at_it(side, off):
    follow = Follow(
        target="car", distance=5.0, side=side, bearing_deg=math.degrees(0.5), height=7.0
    )
    memory = None
    flown = []
    stepped = fly(follow, (-5.0, 0.0, -5.0), 0.1, moving)
    assert not stepped[0].step.done
    flown = fly_on(follow, (-5.0, 0.0, -5.0), 40.0, memory)
    for seen, step in flown:
        if not 12.0 < seen.now < 20.0 and not seen.now > 32.0:
            continue
        car = moving(seen.now)["car"]
        course = math.atan2(car.velocity[1], car.velocity[0])
        angle = off if side == "bearing" else course + off
        place = car.position + 5.0 * vec(math.cos(angle), math.sin(angle), 0.0)
        assert math.dist(place[:2], seen.position[:2]) < 1.0
        assert seen.position[2] == pytest.approx(-7.0, abs=0.3)
        north, east, _ = car.position - seen.position
        assert step.guidance.yaw == pytest.approx(math.atan2(east, north))


def fly_on(behavior, start, seconds, memory):
    """Fly on though it is done: `follow` is, and goes on."""

    class Endless(type(behavior)):
        def step(self, seen, memory):
            return super().step(seen, memory)._replace(done=False)

    return fly(Endless(**behavior.model_dump()), start, seconds, moving, memory=memory)


def test_a_target_out_of_sight_is_waited_for():
    lost = lambda now: {"car": marker(9.0, 0.0, 0.0, seen_at=0.0)}  # noqa: E731
    flown = fly(Follow(target="car", distance=20.0), (0.0, 0.0, -5.0), 3.0, lost)
    assert flown[-1].step.guidance is None
    assert "out of sight" in flown[-1].step.note
    assert fly(Follow(target="car"), (0, 0, -5), 0.1)[0].step.note == "car is not known"
