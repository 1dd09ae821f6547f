"""A plug-in as a parameter of another: the herding policy of `herd`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import pytest
from behaviors.playing import at
from pydantic import BaseModel

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import MissionkitError
from missionkit.messages.herd import HerdChoice, HerdView
from missionkit.planning.herding.dynamic_programme import DynamicProgramme

MISSION = Path("missions/herding.yaml")


class LastRobot(BaseModel):
    """A herding policy: the last robot."""

    model_config = {"frozen": True, "extra": "forbid", "allow_inf_nan": False}
    kind: ClassVar[str] = "last_robot"

    def choose(self, view: HerdView) -> HerdChoice:
        return HerdChoice(view.robots[-1].name, "wait", values={view.robots[-1].name: 1.0})


def herd(policy, catalogue=None, text=""):
    mission = load(text or MISSION, catalogue or builtin(), {"policy": policy})
    return mission.states["herd"].behavior.plugin


def test_a_policy_of_another_package_chooses():
    behavior = herd("last_robot", builtin().with_class(LastRobot))
    assert behavior.policy == LastRobot()
    step = behavior.step(at(10.0, 0.0, 0.0, -2.5), None)
    assert "looking for unseen_10" in step.note


def test_a_policy_that_herd_makes_knows_its_times():
    behavior = herd("dynamic_programme")
    assert behavior.policy == "dynamic_programme"
    assert behavior._policy().land == behavior.land


def test_a_policy_with_parameters_is_taken_as_it_is_given(tmp_path):
    path = tmp_path / "mission.yaml"
    text = MISSION.read_text().replace(
        "policy: $policy", "policy: {use: dynamic_programme, land: 3}"
    )
    text = text.replace("world: worlds/iarc7.yaml\n", "")
    path.write_text(text.replace("policy: dynamic_programme, turns", "turns"))
    mission = load(path, builtin())
    assert mission.states["herd"].behavior.plugin._policy() == DynamicProgramme(land=3)


@pytest.mark.parametrize(
    ("policy", "says"),
    [("nobody", "unknown herding policy 'nobody'; known: dynamic_programme"), ("3", "3")],
)
def test_what_is_none_is_refused_in_a_sentence(policy, says):
    with pytest.raises(MissionkitError) as error:
        herd(policy)
    assert says in str(error.value)
