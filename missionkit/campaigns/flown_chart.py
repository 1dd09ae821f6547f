"""The charts that a campaign flew, to be drawn with what came of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from missionkit.campaigns.campaign_plan import Campaign, digest_of
from missionkit.campaigns.single_run import loaded
from missionkit.campaigns.visit_log import way
from missionkit.chart.drawing.problem_marks import Way
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.errors import MissionkitError, UsageError


class Charted(NamedTuple):
    """A mission of one variant, and what its rows call its transitions."""

    mission: Mission  # with its default failsafes written out
    ways: Mapping[Way, str]

    @property
    def names(self) -> list[str]:
        """The states that can be entered for a while: no history."""
        return [name for name, state, _ in self.mission.walk() if state.history is None]


def charted(mission: Mission, catalogue: Catalogue) -> Charted:
    """Return a mission with the names of its transitions."""
    chart = compile_mission(mission, catalogue)
    ways = {
        (name, number): way(name, ", ".join(each.to) or name, each.text)
        for name, state in chart.states.items()
        for number, each in enumerate(state.transitions)
    }
    return Charted(fulfilled(mission, catalogue), ways)


def flown_chart(campaign: Campaign, settings: Mapping[str, str]) -> Charted:
    """Return the chart that a variant of a campaign flew.

    Args:
        campaign: the plan of the campaign.
        settings: of the variant.

    Raises:
        UsageError: its files are gone or were changed.
    """
    path, plugins = Path(campaign.mission), tuple(map(Path, campaign.plugins))
    try:
        mission, catalogue, _, _ = loaded(campaign.order(Path()), settings)
        same = digest_of(mission, path, plugins) == campaign.digest
    except (MissionkitError, OSError) as error:
        raise UsageError(f"it can no longer be read: {error}") from error
    if not same:
        raise UsageError(f"{path}: it or a file it uses has changed since the campaign was flown")
    return charted(mission, catalogue)
