"""The page of the live view, made of rich's tables. Imported late."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from missionkit.errors import printable
from missionkit.geometry import norm
from missionkit.messages import TRACKED, Cycle, Estimate, Fired, Record, Verdict
from missionkit.recorder.problem_log import Noted

TICK_BUDGET = 0.050  # s, P1 section 9.1
BAR = 12  # letters
EVENTS_SHOWN = 5  # events shown
ROOMY = 100  # letters a line needs for the margins to be shown too
FRAME = 10  # lines besides guards and events: border 2, state to cycle 4, gaps 2, heading, cursor
ECHO = 2  # letters kept free: a terminal writes ^C there, and would begin a new line

VERDICT_MARKS = {True: ("●", "green"), False: ("○", "bright_black"), None: ("?", "yellow")}

Event = tuple[float, Fired | Noted]
"""When (s), and the transition that was taken or the problem that came up, the last time."""


def page(
    record: Record,
    events: Sequence[Event],
    title: str = "",
    *,
    width: int = 120,
    height: int = 40,
    over_ground: bool = True,
) -> Panel:
    """Return the page of one tick.

    Args:
        record: the tick.
        events: transitions and problems so far, oldest first.
        title: what is flown.
        width: of the terminal (letters).
        height: of the terminal (lines); what does not fit is left out, old events first.
        over_ground: place from take-off; else in the mother-ship's frame.
    """
    room = max(height - FRAME, 4)
    guards = record.verdicts[: room - 1]
    latest = _rows(events[-EVENTS_SHOWN:])[-min(room - len(guards), EVENTS_SHOWN) :]
    parts: list[RenderableType] = [
        _state(record),
        _motion(record.estimate, over_ground=over_ground),
        _targets(record.estimate),
        _cycle(record.cycle),
    ]
    if guards:
        parts += [Text(), _guards(guards, margins=width >= ROOMY)]
    if latest:
        parts += [Text(), _events(latest)]
    return Panel(
        Group(*parts),
        title=Text(printable(title)) if title else None,  # no markup
        title_align="left",
        border_style="blue",
        width=width - ECHO,
    )


def bar(verdict: Verdict) -> Text:
    """Draw value against threshold: the fill passes the mark in the middle as the value does.

    Either end is one threshold away from it; a guard without numbers has no bar.
    """
    if verdict.value is None or verdict.threshold is None:
        return Text()
    share = 0.5 + 0.5 * (verdict.value - verdict.threshold) / (abs(verdict.threshold) or 1.0)
    filled = round(BAR * min(max(share, 0.0), 1.0))
    half = BAR // 2
    text = Text(
        f"{'━' * min(filled, half):─<{half}}┃{'━' * max(filled - half, 0):─<{half}}",
        style=VERDICT_MARKS[_three(verdict.holds)][1],
    )
    text.stylize("bold default", half, half + 1)
    return text


def _three(holds: bool | None) -> bool | None:  # noqa: FBT001
    """Return a plain boolean, also for numpy's."""
    return None if holds is None else bool(holds)


def _line(*parts: str | tuple[str, str]) -> Text:
    """Return one line, cut where it does not fit."""
    return Text.assemble(*parts, no_wrap=True, overflow="ellipsis")


def _state(record: Record) -> Text:
    note = f" ({printable(record.step_note)})" if record.step_note else ""
    return _line(
        (record.state, "bold cyan"),
        (note, "italic"),
        f" for {record.now - record.estimate.entered_at:.1f} s",
        ("  mode ", "dim"),
        record.mode.value,
        ("  time ", "dim"),
        f"{record.now:.1f} s",
    )


def _motion(seen: Estimate, *, over_ground: bool) -> Text:
    x, y, z = seen.position.tolist()
    speed = norm(seen.velocity)
    place: tuple[str | tuple[str, str], ...] = (
        f"x {x:6.3f}  y {y:6.3f}  z {z:6.3f} m",
        ("  speed ", "dim"),
        f"{1000.0 * speed:5.1f} mm/s",
    )
    if over_ground:
        place = (
            f"{x:6.2f} N {y:7.2f} E",
            ("  height ", "dim"),
            f"{0.0 - z:5.2f} m",
            ("  speed ", "dim"),
            f"{speed:4.1f} m/s",
        )
    charge = "" if seen.battery is None else f"{100.0 * seen.battery.charge:.0f} %"
    return _line(
        *place,
        ("  ± ", "dim"),
        f"{seen.health.position_sd:.2f} m",
        ("  battery " if charge else "", "dim"),
        charge,
    )


def _targets(seen: Estimate) -> Text:
    text = _line()
    for target in (it for name, it in seen.targets.items() if name != TRACKED):
        ago = "not seen yet" if target.seen_at is None else f"{seen.now - target.seen_at:.1f} s ago"
        gap = norm(target.position - seen.position)
        text.append(f"{target.name} ", style="dim")
        text.append(f"{gap:.2f} m ± {target.position_sd:.2f} m, {ago}  ")
    return text


def _cycle(cycle: Cycle) -> Text:
    share = cycle.total / TICK_BUDGET
    style = "red" if share > 1.0 else "yellow" if share > 0.5 else "green"
    return _line(
        ("cycle ", "dim"),
        (f"{1e3 * cycle.total:.1f}", style),
        f" of {1e3 * TICK_BUDGET:.0f} ms ",
        f"(sense {1e3 * cycle.sense:.1f}, process {1e3 * cycle.process:.1f}, "
        f"control {1e3 * cycle.control:.1f}), {cycle.overruns} overruns",
    )


def _guards(verdicts: Sequence[tuple[str, Verdict]], *, margins: bool) -> Table:
    table = Table(box=None, padding=(0, 1, 0, 0), header_style="dim", expand=True)
    table.add_column("", width=1)
    table.add_column("guard", no_wrap=True, overflow="ellipsis", ratio=5)
    numbers = ("value", "threshold", "margin") if margins else ("value", "threshold")
    for heading in numbers:
        table.add_column(heading, justify="right", width=9)
    table.add_column("", width=BAR + 1)
    table.add_column("why", no_wrap=True, overflow="ellipsis", ratio=3)
    for name, verdict in verdicts:
        mark, style = VERDICT_MARKS[_three(verdict.holds)]
        shown = [_number(getattr(verdict, heading)) for heading in numbers]
        why = Text(printable(verdict.why))
        table.add_row(Text(mark, style=style), Text(name), *shown, bar(verdict), why)
    return table


def _number(value: float | None) -> str:
    return "" if value is None else f"{round(value, 4):.3g}"


def _rows(events: Sequence[Event]) -> list[tuple[str, Text]]:
    """Return time and text of each event, and of what a transition logged below it."""
    rows = []
    for at, event in events:
        texts = [_problem(event)] if isinstance(event, Noted) else [_transition(event)]
        texts += [] if isinstance(event, Noted) else map(_logged, event.logged)
        rows += [(f"{at:.1f} s", text) for text in texts]
    return rows


def _events(rows: Sequence[tuple[str, Text]]) -> Table:
    table = Table(box=None, padding=(0, 1, 0, 0), show_header=False)
    table.add_column(style="dim", justify="right", no_wrap=True, min_width=7)
    table.add_column(no_wrap=True)
    for at, text in rows:
        table.add_row(at, text)
    return table


def _problem(problem: Noted) -> Text:
    again = f" ({problem.times} times)" if problem.times > 1 else ""
    return _line((f"! {printable(problem.says)}{again}", "red"))


def _logged(text: str) -> Text:
    return _line(("log: ", "dim"), printable(text))


def _transition(fired: Fired) -> Text:
    return _line(f"{fired.source} → {fired.to}", (f"  {printable(fired.reason)}", "dim"))
