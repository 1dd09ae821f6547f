"""The part of the report about the chart: what was flown of it, what never was, what to expect."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from missionkit.campaigns.analysis import Variant
from missionkit.campaigns.campaign_plan import Campaign
from missionkit.campaigns.chart_coverage import (
    Unflown,
    countable,
    coverage,
    unflown,
)
from missionkit.campaigns.chart_notes import expected, notes
from missionkit.campaigns.flown_chart import Charted, flown_chart
from missionkit.campaigns.markov_chain import passed
from missionkit.campaigns.number_format import percent, plural, table
from missionkit.campaigns.statistics import wilson
from missionkit.chart.drawing.svg_chart import svg
from missionkit.errors import UsageError

Drawable = Charted | str
"""A chart, or why there is none to draw."""
CAMERAS = {
    "none": "none",
    "rendered": "rendered images, in which the markers had to be found",
    "device": "rendered images in place of the device's",
    "corners": "corners: the detector was given the markers without an image; the effect of light, "
    "blur and background on detection was not simulated",
}
LISTED_KINDS = ("state", "transition", "failsafe")


def drawable(campaign: Campaign, variant: Variant) -> Drawable:
    """Return the chart that a variant flew, if it is still what it was."""
    if not countable(variant.rows):
        return "the runs were flown by an older missionkit, which did not distinguish transitions"
    try:
        return flown_chart(campaign, variant.settings)
    except UsageError as error:
        return str(error)


def simulated(chart: Drawable) -> list[tuple[str, str]]:
    """Return what stood for world, camera and navigation, a line each."""
    if isinstance(chart, str):
        return []
    mission, camera = chart.mission, chart.mission.camera.use
    return [
        ("world", escape(mission.world or "an empty field")),
        ("camera", escape(CAMERAS.get(camera, camera))),
        ("navigation", escape(mission.navigation.kind)),
    ]


def never(variant: Variant, chart: Drawable) -> str:
    """Return in one sentence how much of the chart no flight has shown."""
    if isinstance(chart, str):
        return "How much of the chart was flown is unknown: the chart can no longer be read."
    missed = list(unflown(chart, coverage(variant.rows)))
    if not missed:
        return "Every state, transition and failsafe of the chart was flown."
    totals = len(chart.names), len(chart.ways), len(chart.mission.failsafes)
    counts = [sum(it.what == kind for it in missed) for kind in LISTED_KINDS]
    missing = [
        f"{count} of {plural(total, kind)}"
        for kind, count, total in zip(LISTED_KINDS, counts, totals, strict=True)
        if count
    ]
    return f"Never flown: {', '.join(missing)}; these flights say nothing about them."


def chart_section(variant: Variant, chart: Drawable, key: str) -> Iterator[str]:
    """Yield the picture, what it lacks, and the chain.

    Args:
        variant: what was flown.
        chart: its chart.
        key: tells the picture from others on the page.
    """
    yield "<h2>The chart as flown</h2>"
    if isinstance(chart, str):
        yield f'<p class="soft">The chart is not drawn: {escape(chart)}.</p>'
    else:
        counts = coverage(variant.rows)
        drawn = svg(
            chart.mission, overlay=notes(chart, counts, variant.chain, variant.name), key=key
        )
        yield f'<div class="wide">{drawn}</div>'
        yield from _unflown(list(unflown(chart, counts)))
    yield from _chain(variant)
    yield from _failing(variant)


def _unflown(missed: list[Unflown]) -> Iterator[str]:
    if not missed:
        return
    yield "<h3>Never flown</h3>"
    yield (
        '<p class="small soft">No flight has shown what happens there. The last column: how often '
        "a visit (for a failsafe: a flight) might still lead there, with 95 % confidence.</p>"
    )
    heads = ("", "never reached or taken", "+out of", "+at most")
    yield table(heads, [_missed(it) for it in missed])


def _missed(it: Unflown) -> tuple[str, ...]:
    if it.chances is None:
        return it.what, escape(it.name), "", ""
    unit = "flight" if it.what == "failsafe" else "visit"
    at_most = percent(wilson(0, it.chances).high) if it.chances else "—"
    return it.what, escape(it.name), plural(it.chances, unit), at_most


def _chain(variant: Variant) -> Iterator[str]:
    chain = variant.chain
    yield "<h3>From each state</h3>"
    counted, rows = passed(variant.rows), []
    for (state, word), dwell in zip(expected(chain).items(), chain.dwell, strict=True):
        runs, happy = counted[state]
        shares = percent(happy / runs), percent(word.success), percent(word.crash)
        times = f"{dwell:.1f} s", f"{word.left:.0f} s"
        rows.append((escape(state), str(runs), *shares, *times))
    chances = "+of them successful", "+chain: success", "+chain: crash"
    heads = ("from", "+runs that visited it", *chances, "+a visit lasts", "+until the end")
    yield table(heads, rows)


def _failing(variant: Variant) -> Iterator[str]:
    """Yield the most likely way to failure: by the chain, and how many really went it."""
    way = variant.failure
    if way is None:
        return
    went = sum(
        row.outcome == way.ending.outcome and tuple(s for s, _ in row.visits) == way.states
        for row in variant.rows
    )
    ending = f"{way.ending.outcome.replace('_', ' ')} in {way.ending.state}"
    path = escape(" → ".join((*way.states, ending)))
    yield (
        f"<p>The most likely way to fail: <b>{path}</b>, {percent(way.probability)} of all "
        f"flights by the chain; {went} of {len(variant.rows)} took it.</p>"
    )
