"""`missionkit graph --campaign`: which flights are drawn over a chart."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from missionkit.campaigns import run_journal
from missionkit.campaigns.campaign_loop import counted
from missionkit.campaigns.campaign_plan import Campaign, digest_of, found
from missionkit.campaigns.chart_coverage import countable, coverage
from missionkit.campaigns.chart_notes import notes
from missionkit.campaigns.flown_chart import charted
from missionkit.campaigns.markov_chain import estimate
from missionkit.campaigns.run_row import Row
from missionkit.campaigns.variants import name_of, variants
from missionkit.chart.drawing.chart_overlay import Overlay
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import UsageError


class CampaignOverlay(NamedTuple):
    """The flights of one variant of a campaign."""

    folder: Path
    campaign: Campaign
    settings: Mapping[str, str]  # of the variant
    rows: tuple[Row, ...]

    @property
    def values(self) -> Mapping[str, str]:
        """All parameters that were set."""
        return {**self.campaign.settings, **self.settings}

    @property
    def plugins(self) -> tuple[Path, ...]:
        """The plug-in files that were used."""
        return tuple(map(Path, self.campaign.plugins))

    def overlay(self, path: Path, mission: Mission, catalogue: Catalogue) -> Overlay:
        """Return what is drawn over the chart of a mission.

        Args:
            path: of the mission file.
            mission: loaded from it, with the values that were flown.
            catalogue: with the plug-ins of the campaign.

        Raises:
            UsageError: other files were flown.
        """
        if digest_of(mission, path, self.plugins) != self.campaign.digest:
            raise _other(self.folder, self.campaign, path)
        chart, chain = charted(mission, catalogue), estimate(self.rows)
        return notes(chart, coverage(self.rows), chain, name_of(self.values))


def flown(folder: Path, path: Path, wanted: Mapping[str, str]) -> CampaignOverlay:
    """Return the flights of the first variant with the wanted parameters.

    Args:
        folder: of the campaign.
        path: of the mission.
        wanted: values of parameters, as many as are of interest.

    Raises:
        UsageError: the folder holds no campaign or one of another mission, no such variant, or
            no run that can be drawn.
    """
    plan = found(folder)
    copy = folder / "mission.yaml"
    if copy.is_file() and copy.read_bytes() != path.read_bytes():
        raise _other(folder, plan, path)
    every = variants(plan.vary)
    fitting = [n for n, it in enumerate(every) if wanted.items() <= {**plan.settings, **it}.items()]
    if not fitting:
        names = "; ".join(name_of({**plan.settings, **it}) for it in every)
        raise UsageError(f"{folder}: not flown with {name_of(wanted)}; it was flown with: {names}")
    number = fitting[0]
    rows = tuple(it for it in counted(run_journal.read(folder), plan) if it.variant == number)
    if not any(row.flew for row in rows):
        raise UsageError(f"{folder}: no run has produced a flight yet")
    if not countable(rows):
        raise UsageError(
            f"{folder}: flown by an older missionkit that recorded too little; fly it again"
        )
    return CampaignOverlay(folder, plan, every[number], rows)


def _other(folder: Path, campaign: Campaign, path: Path) -> UsageError:
    return UsageError(
        f"{folder}: is a campaign of {campaign.mission}, as it was when it was flown; {path} is "
        "another mission, or it or a file it uses has changed since"
    )
