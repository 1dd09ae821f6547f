"""The report of a campaign: one HTML page for the person who decides whether to fly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import IntEnum
from html import escape
from pathlib import Path

from missionkit.campaigns import svg_plots
from missionkit.campaigns.analysis import Analysis, Comparison, Variant, broken, command
from missionkit.campaigns.number_format import (
    between,
    figure,
    number,
    percent,
    table,
    title_of,
)
from missionkit.campaigns.report_chart import Drawable, drawable, never, simulated
from missionkit.campaigns.report_template import PAGE
from missionkit.campaigns.report_variant import variant_section
from missionkit.campaigns.run_row import Row
from missionkit.campaigns.statistics import ConfidenceInterval, wilson
from missionkit.campaigns.variants import name_of
from missionkit.recorder.run_folder import write_whole

REPORT_FILE = "report.html"
NOTES = (
    "Every flight was simulated: wind, sensor noise and the faults named above, nothing else. "
    "What the simulator does not model, this page cannot show.",
    "Bounds hold with 95 % confidence: Wilson's interval for rates, percentile bootstrap for "
    "medians and quantiles. A run that hung or broke counts as a failure.",
    "A campaign that stopped early stopped because of its own results, so its interval is a "
    "little too narrow. A requirement decided by the sequential test keeps its risk.",
    "The Markov chain ignores how a state was reached. Where it differs from the runs counted "
    "beside it, the way there matters.",
)


def write_report(folder: Path, results: Analysis) -> Path:
    """Write `report.html`, whole or not at all, and return its path."""
    charts = [drawable(results.campaign, variant) for variant in results.variants]
    write_whole(folder / REPORT_FILE, page(results, charts))
    return folder / REPORT_FILE


def page(results: Analysis, charts: Sequence[Drawable]) -> str:
    """Return the report as one HTML document.

    Args:
        results: analysed campaign.
        charts: of the variants, one each.
    """
    campaign = results.campaign
    seeds = f"seeds {campaign.seed} to {max((row.seed for row in results.rows), default=0)}"
    sub = f"{len(results.rows)} simulated flights, {seeds}; missionkit {campaign.missionkit}"
    parts = [
        *_verdict(results, charts),
        *_flown(results, charts),
        *_comparisons(results),
        *_numbers(results, charts),
    ]
    body = "\n".join([*parts, *_worst(results), *_notes()])
    title = f"{campaign.name}: campaign"
    colour = max(map(_alarm, results.variants)).colour
    return PAGE.substitute(title=escape(title), sub=escape(sub), colour=colour, body=body)


class _Alarm(IntEnum):
    """How a variant looks at a glance."""

    NONE, SOME, HIGH = range(3)

    @property
    def colour(self) -> str:
        return (svg_plots.GOOD, svg_plots.FAIR, svg_plots.BAD)[self]


def _alarm(variant: Variant) -> _Alarm:
    """Crashes, a requirement that is not met, or more failures than successes alarm most."""
    verdict = None if variant.decision is None else variant.decision.verdict
    good = sum(row.succeeded for row in variant.rows)
    crashed = variant.outcomes.get("crash", 0) > 0
    if crashed or verdict == "not met" or 2 * good < len(variant.rows):
        return _Alarm.HIGH
    undecided = verdict == "open" or good < len(variant.rows)
    return _Alarm.SOME if undecided else _Alarm.NONE


def _verdict(results: Analysis, charts: Sequence[Drawable]) -> Iterator[str]:
    yield '<div class="verdict">'
    for variant, chart in zip(results.variants, charts, strict=True):
        if len(results.variants) > 1:
            yield f"<h3>{escape(variant.name)}</h3>"
        good = sum(row.succeeded for row in variant.rows)
        rate = f"{percent(variant.success.value)} of {len(variant.rows)} flights succeeded"
        yield f'<p class="big">{rate}, {between(variant.success, percent)}</p>'
        yield f"<p>{good} of {len(variant.rows)}. {_hurt(variant)}{_broken(variant)}</p>"
        if variant.decision is not None:
            yield f"<p>{_required(results, variant)}</p>"
        yield f"<p>{never(variant, chart)}</p>"
    yield "</div>"
    goal = results.campaign.rule.require
    yield figure(svg_plots.rates([(it.name, it.success) for it in results.variants], goal),
                 "Success rate: dot and 95 % interval" + _dashed(goal))  # fmt: skip
    for variant in results.variants[:1]:
        drawn = svg_plots.running([row.succeeded for row in variant.rows], goal)
        yield figure(drawn, f"How the rate settled, run by run ({variant.name})")


def _dashed(goal: float | None) -> str:
    return "" if goal is None else f"; dashed: required, {percent(goal)}"


def _hurt(variant: Variant) -> str:
    crashes, n = variant.outcomes.get("crash", 0), len(variant.rows)
    rate = wilson(crashes, n)
    if crashes == 0:
        return f"No crash; up to {percent(rate.high)} of flights may still crash. "
    many = "1 crash" if crashes == 1 else f"{crashes} crashes"
    return f'<b class="bad">{many}: {percent(rate.value)}, {between(rate, percent)}.</b> '


def _broken(variant: Variant) -> str:
    count = broken(variant.rows)
    return f'<b class="bad">{count} runs produced no flight.</b>' if count else ""


def _required(results: Analysis, variant: Variant) -> str:
    rule, decided = results.campaign.rule, variant.decision
    if decided is None or rule.require is None:
        return ""
    wanted = f"Required: success above {percent(rule.require)}"
    risk = percent(rule.risk)
    return {
        "met": f'{wanted}: <b class="good">met</b>, decided after {decided.after} runs; wrong '
        f"with probability {risk} at most.",
        "not met": f'{wanted}: <b class="bad">not met</b>, decided after {decided.after} runs; '
        f"if the rate were {percent(rule.hoped)} this would be seen with probability {risk} "
        "at most.",
        "open": f"{wanted}: <b>not decided</b> after {decided.after} runs; fly more.",
    }[decided.verdict]


def _flown(results: Analysis, charts: Sequence[Drawable]) -> Iterator[str]:
    campaign = results.campaign
    first = next((row for row in results.rows if row.parameters), None)
    shown = {} if first is None else first.parameters
    axes = dict(campaign.vary)
    varied = "; ".join(f"{name}: {', '.join(values)}" for name, values in axes.items())
    fixed = ", ".join(f"{name} = {value}" for name, value in shown.items() if name not in axes)
    yield "<h2>What was flown</h2>"
    rows = [
        ("mission", escape(campaign.mission)),
        ("parameters", escape(fixed or "—")),
        ("varied", escape(varied or "—")),
        *simulated(charts[0]),
        ("faults", escape(", ".join(campaign.faults) or "none")),
        ("set by hand", escape(name_of(campaign.settings) if campaign.settings else "nothing")),
        ("files, SHA-256", f"<code>{campaign.digest[:16]}</code>"),
    ]
    yield table((), rows)


def _comparisons(results: Analysis) -> Iterator[str]:
    if not results.comparisons:
        return
    yield f"<h2>Compared with {escape(results.variants[0].name)}, seed by seed</h2>"
    yield (
        '<p class="small soft">Every variant flies with the same wind, noise and faults, so only '
        "the variant differs. p: probability of a split this uneven if the variants were equal "
        "(McNemar).</p>"
    )
    heads = ("variant", "+gain in success", "+only it", "+only the first", "+p")
    yield table(heads, [_comparison(each) for each in results.comparisons])
    names = [name for name, _ in results.comparisons[0].changes]
    columns = ("median change of", *(f"+{escape(each.name)}" for each in results.comparisons))
    yield table(columns, [(title_of(name), *_changes(results, name)) for name in names])


def _comparison(each: Comparison) -> tuple[str, ...]:
    it = each.success
    gain = f"{percent(it.gain.value, sign=True)}, {between(it.gain, percent)}"
    counts = str(it.only_second), str(it.only_first), f"{it.p_value:.2g}"
    return escape(each.name), gain, *counts


def _changes(results: Analysis, name: str) -> Iterator[str]:
    for each in results.comparisons:
        change = dict(each.changes).get(name, ConfidenceInterval(float("nan"), 0.0, 0.0))
        sure = "" if change.low <= 0.0 <= change.high else "<b>{}</b>"
        cell = (
            f"{number(change.value, name, sign=True)}, {between(change, lambda v: number(v, name))}"
        )
        yield sure.format(cell) if sure else cell


def _numbers(results: Analysis, charts: Sequence[Drawable]) -> Iterator[str]:
    for at, (variant, chart) in enumerate(zip(results.variants, charts, strict=True)):
        section = variant_section(variant, chart, f"v{at}-")
        if len(results.variants) == 1:
            yield from section
        else:
            yield f"<details><summary>{escape(variant.name)}</summary>"
            yield from section
            yield "</details>"


def _worst(results: Analysis) -> Iterator[str]:
    yield "<h2>Runs worth a look</h2>"
    yield ('<p class="small soft">Worst first. The command repeats a run and records it.</p>')
    heads = ("+run", "variant", "outcome", "reason and command")
    yield table(
        heads,
        [
            (
                str(row.number),
                escape(name_of(row.settings)),
                row.outcome.replace("_", " "),
                f"{escape(row.reason)}{_where(row)}"
                f"<br><code>{escape(command(results.campaign, row))}</code>",
            )
            for row in results.worst
        ],
    )


def _where(row: Row) -> str:
    """Return the way a flight went, and how near it came to something."""
    clearance = row.metrics.get("clearance")
    near = "" if clearance is None else f"; clearance {clearance:.2f} m"
    path = escape(" → ".join(state for state, _ in row.visits))
    return f'<br><span class="soft">{path}{near}</span>' if path else ""


def _notes() -> Iterator[str]:
    yield "<h2>How to read this</h2><ul class='small'>"
    yield from (f"<li>{note}</li>" for note in NOTES)
    yield "</ul>"
