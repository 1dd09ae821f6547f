"""Live view of a flight: a page on a terminal, plain lines elsewhere."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import TYPE_CHECKING, Self, TextIO

from missionkit.errors import printable
from missionkit.geometry import norm
from missionkit.messages import Fired, Record
from missionkit.number_text import beside_short
from missionkit.recorder import problem_log
from missionkit.recorder.problem_log import Noted

if TYPE_CHECKING:
    from rich.console import Console
    from rich.live import Live

REFRESH = 0.1  # s of wall time between two pages
STATUS_INTERVAL = 5.0  # s of mission time between two plain status lines


def transition_line(at: float, fired: Fired) -> str:
    """Return one line about a transition: time, states, reason, and the guards that decided.

    >>> transition_line(22.05, Fired("gps", "visual", "when marker-sure", (), ()))
    '   22.1 s  gps -> visual: when marker-sure'
    """
    values = [
        "{} {}, limit {}".format(name, *beside_short(verdict.value, verdict.threshold, 3))
        for name, verdict in fired.verdicts
        if verdict.value is not None and verdict.threshold is not None
    ]
    detail = f" ({'; '.join(values)})" if values else ""
    return f"{at:7.1f} s  {fired.source} -> {fired.to}: {fired.reason}{detail}"


def status_line(record: Record, *, over_ground: bool = True) -> str:
    """Return one line about where the vehicle is and how it fares.

    Args:
        record: the tick.
        over_ground: place from take-off, in metres; else in the mother-ship's frame, and a speed
            in millimetres per second.
    """
    seen = record.estimate
    battery = f", battery {100.0 * seen.battery.charge:.0f} %" if seen.battery else ""
    note = f" ({record.step_note})" if record.step_note else ""
    x, y, z = seen.position.tolist()
    if over_ground:
        where = f"{x:.1f} m north, {y:.1f} m east, {0.0 - z:.1f} m high"
        speed = f"{norm(seen.velocity):.1f} m/s"
    else:
        where = f"x {x:.3f} m, y {y:.3f} m, z {z:.3f} m"
        speed = f"{1000.0 * norm(seen.velocity):.1f} mm/s"
    return f"{record.now:7.1f} s  {record.state}{note}: {where}, {speed}{battery}"


def log_lines(at: float, fired: Fired) -> list[str]:
    """Return a line for each `log:` action of a transition.

    >>> log_lines(53.9, Fired("task", "return", "when done", (), ("mode gps", "log finished")))
    ['   53.9 s  log: finished']
    """
    return [f"{at:7.1f} s  log: {text}" for text in fired.logged]


class LineView:
    """Writes a line per transition, log entry and problem, and the status every 5 s of flight.

    A problem that comes up again gets one more line, at the end, with a count.

    Args:
        out: where the lines go.
        logs_only: write the mission's `log:` lines and nothing else.
        over_ground: as for `status_line`.
    """

    def __init__(self, out: TextIO, *, logs_only: bool = False, over_ground: bool = True) -> None:
        self._out = out
        self._logs_only = logs_only
        self._over_ground = over_ground
        self._next_status = 0.0
        self._problems: list[Noted] = []
        self._before = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Say which problems came up more than once."""
        for it in self._problems:
            if it.times > 1:
                self._say(f"{it.last:7.1f} s  problem, {it.times} times so far: {it.says}")

    def update(self, record: Record) -> None:
        """Show one tick."""
        for fired in record.fired:
            if not self._logs_only:
                self._say(transition_line(record.now, fired))
            for line in log_lines(record.now, fired):
                self._say(line)
        if not self._logs_only:
            self._show_state(record)

    def _show_state(self, record: Record) -> None:
        for new in problem_log.note(self._problems, record.problems, record.now, self._before):
            self._say(f"{record.now:7.1f} s  problem: {new.says}")
        self._before = record.now
        if record.now >= self._next_status - 1e-6:
            late = record.now - self._next_status  # a resumed flight begins late
            self._next_status += STATUS_INTERVAL * (1 + (late + 1e-6) // STATUS_INTERVAL)
            self._say(status_line(record, over_ground=self._over_ground))

    def _say(self, line: str) -> None:
        """Write a line; a reader that has gone, as `head` does, must not end the flight."""
        with suppress(BrokenPipeError):
            self._out.write(printable(line) + "\n")
            self._out.flush()


class PageView:
    """Redraws one page in place, at most ten times a second of wall time.

    Args:
        console: a terminal.
        wall: a clock (s) that only paces the drawing.
        title: what is flown.
        over_ground: as for `status_line`.
    """

    def __init__(
        self,
        console: Console,
        wall: Callable[[], float],
        title: str = "",
        *,
        over_ground: bool = True,
    ) -> None:
        self._console = console
        self._over_ground = over_ground
        self._wall = wall
        self._title = title
        self._events: list[tuple[float, Fired | Noted]] = []
        self._problems: list[Noted] = []
        self._last: Record | None = None
        self._drawn = float("-inf")
        self._live: Live | None = None

    def __enter__(self) -> Self:
        from rich.live import Live  # noqa: PLC0415

        self._live = Live(console=self._console, auto_refresh=False, transient=False)
        self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with suppress(OSError):  # a terminal that has gone
            self._draw()
            if self._live is not None:
                self._live.stop()

    def update(self, record: Record) -> None:
        """Show one tick, unless the page was drawn a moment ago."""
        before = record.now if self._last is None else self._last.now
        self._last = record
        self._events += [(record.now, fired) for fired in record.fired]
        problem_log.note(self._problems, record.problems, record.now, before)
        if self._wall() - self._drawn >= REFRESH:
            self._draw()

    def _draw(self) -> None:
        from missionkit.cli.live_page import page  # noqa: PLC0415

        if self._last is None or self._live is None:
            return
        self._drawn = self._wall()
        width, height = self._console.size
        events = sorted((*self._events, *((it.last, it) for it in self._problems)), key=_when)
        shown = page(
            self._last,
            events,
            self._title,
            width=width,
            height=height,
            over_ground=self._over_ground,
        )
        self._live.update(shown, refresh=True)


def _when(event: tuple[float, Fired | Noted]) -> float:
    return event[0]


LiveView = LineView | PageView


def live_view(
    out: TextIO, wall: Callable[[], float], title: str = "", *, over_ground: bool = True
) -> LiveView:
    """Return the view that suits `out`: a page on a terminal, lines elsewhere.

    `NO_COLOR` is respected, as rich does.

    Args:
        out: where the view is written; never closed here.
        wall: s, the clock by which the page is redrawn.
        title: above the page; lines have none.
        over_ground: as for `status_line`.
    """
    if not out.isatty():
        return LineView(out, over_ground=over_ground)
    from rich.console import Console  # noqa: PLC0415

    return PageView(Console(file=out), wall, title, over_ground=over_ground)
