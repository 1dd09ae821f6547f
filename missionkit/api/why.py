"""Why a transition was taken in a recorded flight, or why it was not."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

from missionkit.api.recorded_mission import mission_flown
from missionkit.api.replay import journals
from missionkit.api.transition_change import SmallestChange, replayed_chart, smallest_change
from missionkit.errors import UsageError
from missionkit.recorder.journal_reader import Journal, read_journal, tick_of
from missionkit.replays.asked_transition import (
    AskedTransition,
    named_chart,
    transition_asked,
    transitions_between,
)
from missionkit.replays.guard_outlook import Outlook
from missionkit.replays.state_stays import DecidedTick
from missionkit.replays.transition_conjuncts import Conjunct
from missionkit.replays.transition_explanation import Explanation, explained

MOST_SIGNIFICANT = 4  # digits of values in sentences


class Why(NamedTuple):
    """Why a transition was taken, or why it was not.

    Attributes:
        journal: file of the flight.
        source: state it was asked of.
        to: where it leads.
        reason: when it is taken, as the record says it: "when converged for 1.0 s".
        fired: whether it was taken.
        at: s, mission time in question: when it was taken, or up to when it was not.
        tick: number of that tick.
        conjuncts: the guards that must hold together.
        before: what stood before it, or what decided, a sentence each.
        if_nothing_changes: when it would be taken; None: that cannot be told.
        smallest_change: of the mission's numbers, that would have let it be taken; None: it was
            taken, none was found, or none was asked for.
        notes: sentences: what of this does not hold.

    Example:
        >>> summary = missionkit.rehearse(mission, folder="runs/why")
        >>> (answer,) = missionkit.why("runs/why", "idle->out", at=1.0)
        >>> answer.fired, answer.before
        (False, ())
    """

    journal: Path
    source: str
    to: str
    reason: str
    fired: bool
    at: float
    tick: int
    conjuncts: tuple[Conjunct, ...]
    before: tuple[str, ...]
    if_nothing_changes: Outlook | None
    smallest_change: SmallestChange | None
    notes: tuple[str, ...]

    @property
    def text(self) -> str:
        """All of it for people, a line each."""
        return "\n".join(_lines(self))


def why(
    run: str | Path,
    transition: str,
    *,
    at: float | None = None,
    changes: bool = True,
    plugins: Sequence[str | Path] = (),
) -> tuple[Why, ...]:
    """Say why a transition was taken in a recorded flight, or why it was not.

    If it was taken: which guards decided, with their values, and which came last. If not: how near
    each guard came and when, what stood before the transition, and the smallest change of a number
    in the mission, or of two, with which it would have been taken; a replay verifies that.

    Args:
        run: folder of a run, which may still be flying, or a journal.
        transition: "FROM->TO", two states. What leads there from around FROM counts too.
        at: s, mission time; the first time it was taken if absent, or all the flight if never.
        changes: look for the smallest change; that takes some seconds.
        plugins: plug-in files that the flight used.

    Returns:
        An answer for each transition or failsafe that leads there; only those taken, if any was.

    Raises:
        FileError: the mission cannot be used by this version of missionkit.
        UsageError: there is no journal, it cannot be read, or nothing leads there.

    Example:
        >>> summary = missionkit.rehearse(mission, folder="runs/asked")
        >>> (answer,) = missionkit.why("runs/asked", "idle->out")
        >>> answer.fired, answer.conjuncts[0].guard
        (True, 'done')
    """
    journal = read_journal(journals(Path(run))[0])
    files = [Path(it) for it in plugins]
    with tempfile.TemporaryDirectory() as folder:
        mission = mission_flown(journal, Path(folder), files)
        known = named_chart(mission.model, mission.catalogue)
        source, to = transition_asked(transition, list(known.mission.by_name()))
        between = transitions_between(known, source, to)
        ticks = list(_decided(journal))
        found = [(it, explained(known, it, ticks, at)) for it in between]
        taken = [(it, how) for it, how in found if how.fired is not None]
        flown = cache(lambda: replayed_chart(mission, journal))
        asked = [
            (it, how, smallest_change(mission, known, journal, it, how, flown) if changes else None)
            for it, how in taken or found
        ]
    return tuple(_answer(journal, *each) for each in asked)


def _decided(journal: Journal) -> Iterator[DecidedTick]:
    """Yield what each tick decided.

    Raises:
        UsageError: there are no ticks.
    """
    if not journal.ticks:
        raise UsageError(f"{journal.path}: it holds no tick")
    for now, text in journal.ticks:
        tick = tick_of(journal, text)
        yield DecidedTick(tick.number, now, tick.decision)


def _answer(
    journal: Journal,
    asked: AskedTransition,
    how: Explanation,
    change: SmallestChange | str | None,
) -> Why:
    said = [journal.ends] if journal.ends else []
    if isinstance(change, str):
        said.append(change)
    return Why(
        journal.path,
        asked.source,
        asked.to,
        asked.compiled.text,
        how.fired is not None,
        how.at,
        how.tick,
        how.conjuncts,
        how.before,
        how.if_nothing_changes,
        change if isinstance(change, SmallestChange) else None,
        tuple(said),
    )


def _lines(it: Why) -> Iterator[str]:
    name = f"{it.source} -> {it.to} ({it.reason})"
    if it.fired:
        yield f"{name}: taken at {it.at:.2f} s, tick {it.tick}"
    else:
        yield f"{name}: not taken up to {it.at:.2f} s"
    for each in it.conjuncts:
        yield f"  {_conjunct(each, fired=it.fired)}"
    yield from (f"  {line}" for line in it.before)
    if it.if_nothing_changes is not None:
        ahead = it.if_nothing_changes
        yield f"  if nothing changes: in {ahead.after:.1f} s ({ahead.evidence})"
    if it.smallest_change is not None:
        yield f"  {it.smallest_change.text}"
    yield from (f"  {note}" for note in it.notes)


def _conjunct(it: Conjunct, *, fired: bool) -> str:
    word = {True: "holds", False: "does not hold", None: "unknown"}[it.holds]
    parts = [f"{it.guard}: {word}"]
    if it.value is not None and it.threshold is not None:
        parts.append(f"{it.value:.{MOST_SIGNIFICANT}g}, threshold {it.threshold:g}")
    if it.why:
        parts.append(it.why)
    if it.since is not None:
        parts.append(f"since {it.since:.2f} s")
    if it.closest is not None and not fired and it.holds is not True:
        near = it.closest
        how = f"{-near.margin:.3g} short" if near.margin < 0 else "it held"
        parts.append(f"closest at {near.at:.2f} s: {how}")
    return ", ".join(parts)
