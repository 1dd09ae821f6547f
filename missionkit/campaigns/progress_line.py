"""How far a campaign is, in one line: done, rate, time left, success so far."""

from __future__ import annotations

from collections.abc import Callable
from typing import TextIO

from missionkit.campaigns.run_row import Row
from missionkit.campaigns.statistics import wilson

LINE_INTERVAL = 0.2  # s between two lines on a terminal
QUIETLY = 10.0  # s between two lines elsewhere


class CampaignProgress:
    """Called with every new row; writes a line now and then.

    Args:
        stream: where to; a terminal sees one line that changes.
        stopwatch: s from an arbitrary start.
        known: rows that were there before.
        total: all runs of the campaign.
    """

    def __init__(
        self, stream: TextIO, stopwatch: Callable[[], float], known: list[Row], total: int
    ) -> None:
        self._stream, self._stopwatch, self._total = stream, stopwatch, total
        self._done, self._good = len(known), sum(row.succeeded for row in known)
        self._before = len(known)
        self._since = self._last = stopwatch()
        self._live = stream.isatty()

    def __call__(self, row: Row) -> None:
        """Take in a row."""
        self._done += 1
        self._good += row.succeeded
        now = self._stopwatch()
        if now - self._last >= (LINE_INTERVAL if self._live else QUIETLY):
            self._last = now
            self._write()

    def finish(self) -> None:
        """Write the last line."""
        if self._done > self._before:
            self._write()
        if self._live:
            self._stream.write("\n")

    def _write(self) -> None:
        took = self._stopwatch() - self._since
        text = line(self._done, self._total, self._good, self._done - self._before, took)
        self._stream.write(f"\r\x1b[K{text}" if self._live else f"{text}\n")
        self._stream.flush()


def line(done: int, total: int, good: int, flown: int, took: float) -> str:
    """Return the line.

    >>> line(120, 500, 114, 100, 50.0)
    '120 of 500, success 95.0 % (89.5 to 97.7), 2.0 runs/s, 3 min 10 s left'

    Args:
        done: runs that have ended, in all.
        total: runs of the campaign.
        good: those with success.
        flown: runs that ended since it was resumed.
        took: s since then.
    """
    rate, share = flown / took if took > 0.0 else 0.0, wilson(good, done)
    shown = f"{100 * share.value:.1f} % ({100 * share.low:.1f} to {100 * share.high:.1f})"
    left = f", {spell((total - done) / rate)} left" if rate > 0.0 else ""
    return f"{done} of {total}, success {shown}, {rate:.1f} runs/s{left}"


def spell(seconds: float) -> str:
    """Return a stretch of time in words.

    >>> spell(42.4), spell(190), spell(7300)
    ('42 s', '3 min 10 s', '2 h 1 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
