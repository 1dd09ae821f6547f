"""What patterns remember survives a checkpoint: a flight that is resumed goes on where it was."""

from __future__ import annotations

import pytest
from flying import fly
from playing import marker

from missionkit.behaviors.area_search import ExpandingSquare, Sector
from missionkit.behaviors.climb import Climb
from missionkit.behaviors.follow import Follow
from missionkit.behaviors.loiter import Loiter
from missionkit.behaviors.orbit import Orbit
from missionkit.behaviors.point_at import PointAt
from missionkit.behaviors.survey import Corridor, Survey
from missionkit.behaviors.waypoints import Waypoints
from missionkit.recorder.value_codec import read, written

FIELD = ((0.0, 0.0), (40.0, 0.0), (40.0, 24.0), (0.0, 24.0))
START = (0.0, 0.0, -8.0)


@pytest.mark.parametrize(
    "behavior",
    [
        Waypoints(places=[{"at": (10, 0), "wait": 2}, (0, 0)]),
        Survey(polygon=FIELD, height=20, spacing=6),
        Corridor(line=((0, 0), (50, 0)), breadth=10, spacing=5, height=9),
        Orbit(target="tower", radius=15.0, turns=2),
        ExpandingSquare(),
        Sector(),
        Follow(target="tower"),
        Climb(height=40),
        Loiter(seconds=60),
        PointAt(target="tower"),
    ],
    ids=lambda it: it.kind,
)
def test_a_memory_is_read_as_it_was_written(behavior):
    around = {"tower": marker(20.0, 10.0, -8.0)}
    last = fly(behavior, START, 6.0, lambda _: around)[-1]
    text = written(last.step.memory)
    seen = last.seen
    assert written(read(text)) == text
    kept, lost = behavior.step(seen, read(text)), behavior.step(seen, last.step.memory)
    assert kept.note == lost.note
    assert written(kept.memory) == written(lost.memory)
