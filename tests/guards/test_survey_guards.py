"""Guards of surveys and searches: what was photographed, where it was, the ground, the wind."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from samples import calm

from missionkit.geometry import from_euler
from missionkit.guards.coverage import Covered
from missionkit.guards.event_count import Count
from missionkit.guards.ground_height import HeightAboveGround
from missionkit.guards.visits import Visited
from missionkit.guards.wind_speed import WindAbove
from missionkit.messages import Look
from missionkit.messages.observation import Range
from missionkit.perception.camera_section import Camera, Mount
from missionkit.plugin_protocols import Inputs

FIELD = ((0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (0.0, 30.0))
DOWN = Camera(width=800, height=600, focal=500, mount=Mount(position=(0, 0, 0), tilt_deg=90))
FRAME = (Look(0.0, frozenset()),)


def share(guard, *frames):
    memory = guard.begin()
    for frame in frames:
        memory = guard.advance(memory, calm(looks=FRAME, **frame))
    return guard.check(memory, calm())


def over(north, east, up=10.0, yaw=0.0, **more):
    place = np.array([north, east, -up])
    return {"position": place, "attitude": from_euler(0.0, 0.0, yaw), **more}


def test_a_frame_covers_what_it_shows():
    guard = Covered(polygon=FIELD).with_camera(DOWN.model())
    # 10 m up, 600 px along and 800 px across at 500 px: 12 m x 16 m of 40 m x 30 m
    assert share(guard, over(20.0, 15.0)).value == pytest.approx(12 * 16 / 1200, rel=0.05)
    turned = share(guard, over(20.0, 15.0, yaw=0.5 * math.pi))
    assert turned.value == pytest.approx(12 * 16 / 1200, rel=0.05)
    assert share(guard, over(0.0, 0.0)).value == pytest.approx(6 * 8 / 1200, rel=0.08)
    twice = share(guard, over(20.0, 15.0), over(20.0, 15.0), over(26.0, 15.0))
    assert twice.value == pytest.approx(18 * 16 / 1200, rel=0.05)


def test_it_holds_once_lines_cover_the_area_and_not_before():
    guard = Covered(polygon=FIELD, at_least=0.99).with_camera(DOWN.model())
    lines = [over(float(n), east) for east in (5.0, 15.0, 25.0) for n in range(-2, 44, 2)]
    assert share(guard, *lines).holds
    assert share(guard, *lines[:-23]).holds is False


@pytest.mark.parametrize(
    "spoilt",
    [
        {"velocity": np.array([8.0, 0.0, 0.0])},  # 8 / 10 · 500 · 0.004 = 1.6 px
        {"rates": np.array([0.0, 0.0, 0.8])},
        {"attitude": from_euler(1.2, 0.0, 0.0)},  # the horizon
        {"position": np.array([20.0, 15.0, 1.0])},
        {"looks": (Look(0.0, frozenset(), silent=True),)},
    ],
)
def test_what_is_not_sharp_or_not_of_the_ground_does_not_count(spoilt):
    guard = Covered(polygon=FIELD).with_camera(DOWN.model())
    seen = calm(**({"looks": FRAME} | over(20.0, 15.0) | spoilt))
    assert guard.advance(0, seen) == 0
    fine = calm(**({"looks": FRAME} | over(20.0, 15.0, velocity=np.array([7.0, 0.0, 0.0]))))
    assert guard.advance(0, fine) > 0


def test_without_a_camera_nothing_is_known_of_coverage():
    assert share(Covered(polygon=FIELD), over(20.0, 15.0)).holds is None
    with pytest.raises(ValidationError, match="edges 1 to 2 and 3 to 4 cross"):
        Covered(polygon=((0, 0), (9, 9), (9, 0), (0, 9)))


def test_the_height_above_ground_is_the_range_finders_upright():
    guard = HeightAboveGround(at_most=8.0)
    leaning = calm(range=Range(10.0, 10.0), attitude=from_euler(math.radians(40.0), 0.0, 0.0))
    assert guard.check(leaning).value == pytest.approx(10.0 * math.cos(math.radians(40.0)))
    assert guard.check(leaning).holds
    assert HeightAboveGround(at_least=8.0).check(leaning).holds is False
    assert guard.check(calm()).holds is None
    assert "2.0 s old" in guard.check(calm(range=Range(8.0, 3.0))).why
    over_on = calm(range=Range(10.0, 3.0), attitude=from_euler(1.0, 0.0, 0.0))
    assert "leans by 57 deg" in guard.check(over_on).why
    with pytest.raises(ValidationError, match="one of"):
        HeightAboveGround()


def test_visits_are_counted_by_their_entries():
    guard = Visited(state="look", at_least=2)
    memory = guard.begin()
    story = [("go", 0.0, 4.0), ("look", 5.0, 5.05), ("look", 5.0, 6.0)]
    story += [("look", 6.0, 7.0), ("look", 7.0, 8.0)]  # paused: its clock stands still
    story += [("look", 9.0, 9.05), ("go", 12.0, 13.0)]
    holds = []
    for state, entered, now in story:
        memory = guard.advance(memory, calm(state=state, entered_at=entered, now=now))
        holds.append(guard.check(memory, calm(), Inputs({}, {}, ())).holds)
    assert holds == [False] * 5 + [True, True]
    assert guard.named_inputs()[0].what == "state"


def test_an_event_is_counted_each_time_it_is_heard():
    guard = Count(event="photo", at_least=3)
    memory, holds = guard.begin(), []
    for events in [(), ("photo",), ("go", "photo.taken"), ("photograph",), ("photo",)]:
        memory = guard.advance(memory, calm(events=events))
        holds.append(guard.check(memory, calm()).holds)
    assert holds == [False, False, False, False, True]
    with pytest.raises(ValidationError, match="expected the name of an event"):
        Count(event="two words")


def blown(guard, wind, ground, seconds=20.0):
    """A vehicle that flies at a steady velocity in a steady wind, drag balanced by its tilt."""
    memory = guard.begin()
    air = np.subtract(ground, wind)
    speed = math.hypot(*air)
    push = (guard.linear + guard.quadratic * speed) * air  # m/s², against the drag
    tilt = from_euler(math.atan(push[1] / 9.80665), -math.atan(push[0] / 9.80665), 0.0)
    for n in range(round(seconds / 0.05)):
        seen = calm(now=n * 0.05, velocity=np.array([*ground, 0.0]), attitude=tilt)
        memory = guard.advance(memory, seen)
    return guard.check(memory, seen)


@pytest.mark.parametrize("wind", [(0.0, 0.0), (6.0, 0.0), (-3.0, 4.0), (0.0, -9.0)])
@pytest.mark.parametrize("ground", [(0.0, 0.0), (5.0, -2.0)])
def test_the_wind_is_what_the_tilt_shows(wind, ground):
    verdict = blown(WindAbove(speed=5.5), wind, ground)
    assert verdict.value == pytest.approx(math.hypot(*wind), abs=0.15)
    assert verdict.holds is (math.hypot(*wind) > 5.5)


def test_the_wind_is_unknown_on_the_ground_and_just_after_take_off():
    assert blown(WindAbove(speed=5.0), (6.0, 0.0), (0.0, 0.0), 3.0).holds is None
    guard = WindAbove(speed=5.0)
    landed = calm()._replace(status=calm().status._replace(in_air=False))
    assert guard.advance(guard.advance(None, calm()), landed) is None
    assert guard.check(None, landed).holds is None
