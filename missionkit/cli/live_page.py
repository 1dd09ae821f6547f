"""The page of the live view, made of rich's tables. Imported late."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from missionkit.geometry import norm
from missionkit.messages import Cycle, Estimate, Fired, Record, Verdict

BUDGET = 0.050  # s, P1 section 9.1
BAR = 12  # letters
LAST = 5  # transitions shown

HOLDS = {True: ("●", "green"), False: ("○", "bright_black"), None: ("?", "yellow")}


def page(record: Record, history: Sequence[tuple[float, Fired]], title: str = "") -> Panel:
    """Return the page of one tick.

    Args:
        record: the tick.
        history: transitions so far with their times (s), oldest first.
        title: what is flown.
    """
    parts: list[RenderableType] = [
        _state(record, history),
        _motion(record.estimate),
        _targets(record.estimate),
        _cycle(record.cycle),
    ]
    if record.verdicts:
        parts += [Text(), _guards(record.verdicts)]
    if record.problems:
        parts += [Text(), *[Text(f"! {it}", style="bold red") for it in record.problems]]
    if history:
        parts += [Text(), _history(history)]
    return Panel(Group(*parts), title=title or None, title_align="left", border_style="blue")


def bar(said: Verdict) -> Text:
    """Draw value against threshold: the fill passes the mark in the middle as the value does.

    Either end is one threshold away from it; a guard without numbers has no bar.
    """
    if said.value is None or said.threshold is None:
        return Text()
    share = 0.5 + 0.5 * (said.value - said.threshold) / (abs(said.threshold) or 1.0)
    filled = round(BAR * min(max(share, 0.0), 1.0))
    half = BAR // 2
    text = Text(
        f"{'━' * min(filled, half):─<{half}}┃{'━' * max(filled - half, 0):─<{half}}",
        style=HOLDS[_three(said.holds)][1],
    )
    text.stylize("bold default", half, half + 1)
    return text


def _three(holds: bool | None) -> bool | None:  # noqa: FBT001
    """Return a plain boolean, also for numpy's."""
    return None if holds is None else bool(holds)


def _state(record: Record, history: Sequence[tuple[float, Fired]]) -> Text:
    since = history[-1][0] if history else 0.0
    text = Text.assemble(
        (record.state, "bold cyan"),
        f" for {record.now - since:.1f} s",
        ("  mode ", "dim"),
        record.mode.value,
        ("  mission time ", "dim"),
        f"{record.now:.1f} s",
    )
    if history:
        text.append(f"  before: {history[-1][1].source}", style="dim")
    if record.step_note:
        text.append(f"  {record.step_note}", style="italic")
    return text


def _motion(seen: Estimate) -> Text:
    north, east, down = seen.position.tolist()
    text = Text.assemble(
        ("position ", "dim"),
        f"{north:8.2f} N {east:8.2f} E",
        ("  height ", "dim"),
        f"{0.0 - down:6.2f} m",
        ("  speed ", "dim"),
        f"{norm(seen.velocity):5.2f} m/s",
        ("  ± ", "dim"),
        f"{seen.health.position_sd:.2f} m",
    )
    if seen.battery is not None:
        text.append("  battery ", style="dim")
        text.append(f"{100.0 * seen.battery.charge:.0f} %")
    return text


def _targets(seen: Estimate) -> Text:
    text = Text()
    for target in seen.targets.values():
        ago = "not seen yet" if target.seen_at is None else f"{seen.now - target.seen_at:.1f} s ago"
        gap = norm(target.position - seen.position)
        text.append(f"{target.name} ", style="dim")
        text.append(f"{gap:.2f} m ± {target.position_sd:.2f} m, {ago}  ")
    return text


def _cycle(cycle: Cycle) -> Text:
    share = cycle.total / BUDGET
    style = "red" if share > 1.0 else "yellow" if share > 0.5 else "green"
    return Text.assemble(
        ("cycle ", "dim"),
        (f"{1e3 * cycle.total:.1f}", style),
        f" of {1e3 * BUDGET:.0f} ms ",
        f"(sense {1e3 * cycle.sense:.1f}, process {1e3 * cycle.process:.1f}, "
        f"control {1e3 * cycle.control:.1f}), {cycle.overruns} overruns",
    )


def _guards(verdicts: Sequence[tuple[str, Verdict]]) -> Table:
    table = Table(box=None, padding=(0, 1), header_style="dim")
    table.add_column("")
    table.add_column("guard", no_wrap=True)
    for heading in ("value", "threshold", "margin"):
        table.add_column(heading, justify="right")
    table.add_column("")
    table.add_column("why", overflow="ellipsis", no_wrap=True)
    for name, said in verdicts:
        mark, style = HOLDS[_three(said.holds)]
        numbers = [_number(it) for it in (said.value, said.threshold, said.margin)]
        table.add_row(Text(mark, style=style), name, *numbers, bar(said), said.why)
    return table


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _history(history: Sequence[tuple[float, Fired]]) -> Table:
    table = Table(box=None, padding=(0, 1), show_header=False)
    for at, fired in history[-LAST:]:
        table.add_row(
            Text(f"{at:.1f} s", style="dim"),
            f"{fired.source} → {fired.to}",
            Text(fired.reason, style="dim"),
        )
    return table
