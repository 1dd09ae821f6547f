"""Texts that `missionkit new` writes. `${name}`, `${Class}` and `${folder}` are filled in."""

PROJECT = """\
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "${folder}"
version = "0.1.0"
description = "The ${what} ${name} for missionkit."
requires-python = ">=3.11"
dependencies = ["missionkit"]

[project.entry-points."missionkit.${group}"]
${name} = "${module}:${Class}"

[tool.setuptools]
py-modules = ["${module}"]

[tool.pytest.ini_options]
pythonpath = ["."]
"""

READ_ME = """\
# ${folder}

The ${what} `${name}` for missionkit.

    pytest                                    # its test
    pip install -e .                          # from now on every mission can name it
    missionkit plugins                        # shows it with its parameters

In a mission file:

    ${usage}

Without installing: `missionkit run mission.yaml --plugin ${module}.py`.
"""

GUARD_USAGE = "transitions: [{to: return, when: {use: ${name}, limit: 8.0}}]"

GUARD = '''\
"""A guard for missionkit."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field
from typing_extensions import override

from missionkit import Estimate, Guard, Verdict
from missionkit.units import MetresPerSecond


class ${Class}(Guard):
    """Holds while the vehicle is faster than `limit`; unknown until the estimate has aligned."""

    kind: ClassVar[str] = "${name}"
    limit: MetresPerSecond = Field(default=8.0, gt=0)

    @override
    def check(self, seen: Estimate) -> Verdict:
        if not seen.health.aligned:
            return Verdict.unknown("the estimate has not aligned yet")
        speed = float(np.linalg.norm(seen.velocity))  # m/s
        return Verdict.above(speed, self.limit)
'''

ESTIMATE_FUNCTION = '''\
def estimate(**changes):
    """Return the estimate of a hovering vehicle."""
    hovering = {
        "now": 10.0,
        "position": np.array([0.0, 0.0, -5.0]),  # m, NED
        "velocity": np.zeros(3),  # m/s, NED
        "attitude": np.array([1.0, 0.0, 0.0, 0.0]),
        "rates": np.zeros(3),
        "health": Health(
            aligned=True, diverged=False, gnss_at=10.0, vision_at=None, position_sd=0.5, rejected=0
        ),
    }
    return Estimate(**{**hovering, **changes})
'''

GUARD_TEST = (
    """\
import numpy as np
import pytest
from pydantic import ValidationError

from missionkit import Estimate, Health

from ${module} import ${Class}


"""
    + ESTIMATE_FUNCTION
    + """

@pytest.mark.parametrize(("north", "holds"), [(7.9, False), (8.1, True)])
def test_holds_above_the_limit(north, holds):
    verdict = ${Class}(limit=8.0).check(estimate(velocity=np.array([north, 0.0, 0.0])))
    assert verdict.holds is holds
    assert verdict.margin == pytest.approx(north - 8.0)


def test_is_unknown_before_the_estimate_has_aligned():
    health = estimate().health._replace(aligned=False)
    assert ${Class}().check(estimate(health=health)).holds is None


def test_a_limit_below_zero_is_refused():
    with pytest.raises(ValidationError):
        ${Class}(limit=-1.0)
"""
)

BEHAVIOR_USAGE = "behavior: {use: ${name}, height: 12.0}"

BEHAVIOR = '''\
"""A behaviour for missionkit."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit import Behavior, Estimate, Guidance, Step
from missionkit.geometry import Vec3, vec
from missionkit.units import Metres, MetresPerSecond


class ${Class}(Behavior):
    """Rise or sink to `height` above where the state was entered; done `within` of it."""

    kind: ClassVar[str] = "${name}"
    height: Metres = 5.0
    speed: MetresPerSecond = Field(default=1.0, gt=0)
    within: Metres = Field(default=0.3, gt=0)

    @override
    def begin(self, seen: Estimate) -> Vec3:
        return seen.position + vec(0.0, 0.0, -self.height)  # (3,), m, NED: down is positive

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        gap = abs(float(memory[2] - seen.position[2]))  # m
        guidance = Guidance(memory, self.speed)
        note = f"{gap:.1f} m to go"
        return Step(guidance, done=gap <= self.within, note=note, memory=memory)
'''

BEHAVIOR_TEST = (
    """\
import numpy as np

from missionkit import Estimate, Health

from ${module} import ${Class}


"""
    + ESTIMATE_FUNCTION
    + """

def test_rises_straight_up_and_says_when_it_is_there():
    climb = ${Class}(height=5.0)
    memory = climb.begin(estimate())
    first = climb.step(estimate(), memory)
    np.testing.assert_allclose(first.guidance.position, (0.0, 0.0, -10.0))
    assert not first.done
    there = estimate(position=np.array([0.1, 0.0, -9.9]))
    assert climb.step(there, first.memory).done
"""
)

MISSION_FILE = """\
missionkit: 1
mission: ${name}
summary: Take off, fly to a place, come home, land.
params: {cruise: 4.0, height: 5.0}     # missionkit run ${name}.yaml --set cruise=3
world: worlds/${name}.yaml
vehicle: {use: sim}
camera: {use: none}                    # it looks for nothing

targets:
  place: {position: [30.0, 10.0, -5.0]}     # north, east, down of the take-off point, m

failsafes:                              # before everything else, in every flying state, first wins
  - {name: battery, when: {use: battery_below, floor: 0.25}, unknown: take, to: land}
  - {name: link, when: {use: link_lost, longer_than: 3.0}, to: land}
  - {name: lost, when: {use: estimate_bad}, for: 1.0, to: land}

initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: $$height}
    transitions:
      - {to: out, when: done}
  out:
    kind: gps
    behavior: {use: go_to, target: place, speed: $$cruise}
    transitions:
      - {to: back, when: done}
      - {to: back, after: 60}
  back:
    kind: return
    behavior: {use: go_to, target: home, height: $$height, speed: $$cruise}
    transitions:
      - {to: land, when: done}
      - {to: land, after: 60}
  land:
    kind: land
success: {visit: back}
"""

WORLD_FILE = """\
world: ${name}
ground: {texture: grass}
wind: {mean: [1.0, 0.5, 0.0], gust: 0.5}
obstacles:
  - {use: cylinder, at: [15.0, 4.0], radius: 0.5, height: 8.0}
"""
