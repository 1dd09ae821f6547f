"""The part of the report about one variant: endings, numbers, the chart as flown."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from missionkit.campaigns import svg_plots
from missionkit.campaigns.analysis import Measure, Variant, conditions_of
from missionkit.campaigns.number_format import (
    between,
    figure,
    number,
    percent,
    scaled,
    table,
    title_of,
)
from missionkit.campaigns.report_chart import Drawable, chart_section
from missionkit.campaigns.requirement_statistics import (
    RequirementStatistics,
    requirement_statistics,
)


def variant_section(variant: Variant, chart: Drawable, key: str) -> Iterator[str]:
    """Yield the parts.

    Args:
        variant: what was flown.
        chart: its chart.
        key: tells its picture from others on the page.
    """
    yield from _endings(variant)
    yield from _conditions(variant)
    yield from _requirements(variant)
    yield from _numbers(variant)
    if variant.chain.states:
        yield from chart_section(variant, chart, key)


def _endings(variant: Variant) -> Iterator[str]:
    yield "<h2>How the flights ended</h2>"
    n = len(variant.rows)
    counts = [
        (outcome.replace("_", " "), str(count), percent(count / n))
        for outcome, count in variant.outcomes.items()
    ]
    yield table(("outcome", "+runs", "+share"), counts)
    if variant.reasons:
        yield "<h3>Why flights did not succeed</h3>"
        yield table(
            ("reason", "+runs"), [(escape(why), str(count)) for why, count in variant.reasons]
        )


def _conditions(variant: Variant) -> Iterator[str]:
    """Yield how often each condition of success was met, of the flights that say so."""
    conditions = conditions_of(variant)
    if not conditions:
        return
    yield "<h3>Conditions of success</h3>"
    yield table(
        ("condition", "+met", "+of flights", "+share"),
        [
            (escape(name), str(it["met"]), str(it["flights"]), percent(it["met"] / it["flights"]))
            for name, it in conditions.items()
        ],
    )


def _requirements(variant: Variant) -> Iterator[str]:
    """Yield how often each requirement was fulfilled, and by how much."""
    every = requirement_statistics(variant.rows)
    if not every:
        return
    yield "<h3>Requirements</h3>"
    yield (
        '<p class="small soft">Robustness: how far the guard that decides stayed from breaking '
        "the requirement, in the guard's own unit; below 0 it was broken.</p>"
    )
    heads = ("requirement", "+fulfilled", "+broken", "+of flights", "+share", "+worst robustness")
    yield table((*heads, "+5 % below", "+seed of the worst"), [_requirement(it) for it in every])


def _requirement(it: RequirementStatistics) -> tuple[str, ...]:
    robustness = ("—" if value is None else f"{value:.3g}" for value in (it.worst, it.low))
    counts = str(it.fulfilled), str(it.broken), str(it.flights)
    share = f"{percent(it.share.value)}, {between(it.share, percent)}"
    return escape(it.name), *counts, share, *robustness, str(it.seed)


def _numbers(variant: Variant) -> Iterator[str]:
    if not variant.measures:
        return
    yield "<h2>Numbers</h2>"
    heads = ("", "+5 % of runs below", "+median", "+95 % interval of the median", "+95 % below")
    yield table(heads, [_quantiles(measure) for measure in variant.measures])
    yield '<div class="row">'
    for measure in variant.measures:
        name = measure.name
        values = [(row.succeeded, row.metrics.get(name)) for row in variant.rows]
        good = scaled(name, [v for success, v in values if success and v is not None])
        bad = scaled(name, [v for success, v in values if not success and v is not None])
        yield figure(svg_plots.histogram(good, bad, title_of(name)), title_of(name))
    yield "</div>"
    yield (
        '<p class="small soft">Runs in each column; '
        f'<span style="color:{svg_plots.GOOD}">■</span> successful, '
        f'<span style="color:{svg_plots.BAD}">■</span> not.</p>'
    )


def _quantiles(measure: Measure) -> tuple[str, ...]:
    low, middle, high = measure.quantiles
    name = measure.name
    bounds = f"{number(middle.low, name)} to {number(middle.high, name)}"
    shown = number(low.value, name), number(middle.value, name), bounds, number(high.value, name)
    return title_of(name), *shown
