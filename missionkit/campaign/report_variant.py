"""The part of the report that tells of one variant: endings, numbers, the chart as flown."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from missionkit.campaign import plots
from missionkit.campaign.analysis import Measure, Variant
from missionkit.campaign.chain import absorbed, passed, time_left
from missionkit.campaign.chain_picture import picture
from missionkit.campaign.wording import figure, number, percent, scaled, table, title_of


def variant_section(variant: Variant) -> Iterator[str]:
    """Yield the parts."""
    yield from _endings(variant)
    yield from _numbers(variant)
    if variant.chain.states:
        yield from _chart(variant)


def _endings(variant: Variant) -> Iterator[str]:
    yield "<h2>How the flights ended</h2>"
    n = len(variant.rows)
    counts = [
        (outcome.replace("_", " "), str(count), percent(count / n))
        for outcome, count in variant.outcomes.items()
    ]
    yield table(("outcome", "+runs", "+share"), counts)
    if variant.reasons:
        yield "<h3>Why not with success</h3>"
        yield table(
            ("reason", "+runs"), [(escape(why), str(count)) for why, count in variant.reasons]
        )


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
        yield figure(plots.histogram(good, bad, title_of(name)), title_of(name))
    yield "</div>"
    yield (
        '<p class="small soft">Runs in each column; '
        f'<span style="color:{plots.GOOD}">■</span> with success, '
        f'<span style="color:{plots.BAD}">■</span> without.</p>'
    )


def _quantiles(measure: Measure) -> tuple[str, ...]:
    low, middle, high = measure.quantiles
    name = measure.name
    bounds = f"{number(middle.low, name)} to {number(middle.high, name)}"
    shown = number(low.value, name), number(middle.value, name), bounds, number(high.value, name)
    return title_of(name), *shown


def _chart(variant: Variant) -> Iterator[str]:
    chain = variant.chain
    yield "<h2>The chart as it was flown</h2>"
    yield figure(picture(chain), "Of the visits to a state, the share that went each way.")
    ends, left = absorbed(chain.inner, chain.outer), time_left(chain.inner, chain.dwell)
    counted = passed(variant.rows)
    good = [n for n, ending in enumerate(chain.endings) if ending.outcome == "success"]
    hurt = [n for n, ending in enumerate(chain.endings) if ending.outcome == "crash"]
    rows = []
    for n, state in enumerate(chain.states):
        runs, happy = counted[state]
        success, crash = (float(ends[n, which].sum()) for which in (good, hurt))
        shares = percent(happy / runs), percent(success), percent(crash)
        times = f"{chain.dwell[n]:.1f} s", f"{left[n]:.0f} s"
        rows.append((escape(state), str(runs), *shares, *times))
    chances = "+of them with success", "+chain: success", "+chain: crash"
    heads = ("from", "+runs that were there", *chances, "+a visit lasts", "+until the end")
    yield table(heads, rows)
    yield from _failing(variant)


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
        f"flights by the chain; {went} of {len(variant.rows)} went it.</p>"
    )
