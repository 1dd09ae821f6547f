"""Which state is active: one pure step per tick.

Order of precedence: the pilot, then failsafes in document order, then the state's invariant,
then its transitions in document order. Failsafes ignore the dwell; a failsafe never leads back
to something less safe than what is already happening (land before return before anything else).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from missionkit.chart.compiled import Chart, Output, Question, State, Transition
from missionkit.chart.contain import Containment
from missionkit.messages import Estimate, Fired, Verdict

ABORT = "operator: land"
EPSILON = 1e-9  # s; ticks are multiples of the period, up to rounding
_SAFETY = {"land": 2, "return": 1}


class ChartMemory(NamedTuple):
    """Where the chart stands."""

    state: str
    entered_at: float
    windows: tuple[Any, ...]
    held: Mapping[int, float]  # transition -> since when its guard has held
    violated_since: float | None = None
    started: bool = False  # the initial state's entry was carried out
    raised: tuple[str, ...] = ()  # events raised by outputs, seen at the next tick


class Decision(NamedTuple):
    """What one tick decided."""

    answers: tuple[tuple[str, Verdict], ...]
    fired: Fired | None
    entered: bool  # a state was entered at this tick
    problems: tuple[str, ...]


def begin(chart: Chart, now: float) -> ChartMemory:
    """Return the memory before the first tick."""
    windows = tuple(slot.begin() for slot in chart.slots)
    return ChartMemory(chart.initial, now, windows, {})


def decide(
    chart: Chart, memory: ChartMemory, seen: Estimate, contain: Containment
) -> tuple[ChartMemory, Decision]:
    """Advance the guards' windows, choose at most one transition, and take it."""
    question = Question(seen, memory.windows, contain)
    windows = _advanced(chart, question)
    state = chart.states[memory.state]
    events = seen.events + memory.raised
    held, chosen = _chosen(chart, state, memory, question, events)
    violated, escape, problems = _invariant(state, memory, question)
    fired = _first(chart, state, chosen, escape, events)
    opening = () if memory.started else state.entry
    if fired is None or (fired.to == state.name and fired.event is None):
        fired = Transition(-1, state.name, "start") if opening else None
        outputs, entered = opening, not memory.started
        following = memory._replace(windows=windows, held=held, violated_since=violated)
    else:
        outputs = (*opening, *state.exit, *fired.outputs, *chart.states[fired.to].entry)
        lasting = {f.number: held[f.number] for f in chart.failsafes if f.number in held}
        following, entered = ChartMemory(fired.to, seen.now, windows, lasting), True
    following = following._replace(started=True, raised=_raised(outputs))
    news = None if fired is None else _explained(chart, state, fired, outputs, question)
    return following, Decision(tuple(question.answers.items()), news, entered, problems)


def _first(
    chart: Chart,
    state: State,
    chosen: Transition | None,
    escape: Transition | None,
    events: tuple[str, ...],
) -> Transition | None:
    """Return who goes first: the pilot, a failsafe, the way out of I(s), a transition."""
    if ABORT in events and state.kind.name != "land":
        return Transition(-1, chart.land, ABORT)
    if escape is None or (chosen is not None and chosen in chart.failsafes):
        return chosen
    return escape


def _raised(outputs: tuple[Output, ...]) -> tuple[str, ...]:
    return tuple(output.text for output in outputs if output.verb == "raise")


def _advanced(chart: Chart, question: Question) -> tuple[Any, ...]:
    """Advance every memory; one that asks another guard finds it in a slot before its own."""
    question.windows = windows = list(question.windows)
    for index, slot in enumerate(chart.slots):
        windows[index] = slot.advance(windows[index], question)
    return tuple(windows)


def _chosen(
    chart: Chart,
    state: State,
    memory: ChartMemory,
    question: Question,
    events: tuple[str, ...],
) -> tuple[Mapping[int, float], Transition | None]:
    """Ask every guard of the state, so that the record explains also what did not happen."""
    held: dict[int, float] = {}
    chosen: Transition | None = None
    if _flying(question.seen, state):
        obeyed = False
        for failsafe in chart.failsafes:
            ready = _enabled(failsafe, memory, question, events, held)
            obeyed = obeyed or (ready and failsafe.to == state.name)
            if ready and chosen is None and _safer(chart, state, failsafe.to, obeyed=obeyed):
                chosen = failsafe
    rested = question.seen.now - memory.entered_at >= state.dwell - EPSILON
    for transition in state.transitions:
        ready = _enabled(transition, memory, question, events, held)
        if ready and chosen is None and (rested or not transition.patient):
            chosen = transition
    return held, chosen


def _enabled(
    transition: Transition,
    memory: ChartMemory,
    question: Question,
    events: tuple[str, ...],
    held: dict[int, float],
) -> bool:
    now = question.seen.now
    if transition.ask is not None:
        holds = transition.ask(question).holds
        if not (transition.unknown_takes if holds is None else holds):
            return False
        since = memory.held.get(transition.number, now)
        held[transition.number] = since
        if now - since < transition.hold - EPSILON:
            return False
    if transition.after is not None and now - memory.entered_at < transition.after - EPSILON:
        return False
    return transition.event is None or transition.event in events


def _flying(seen: Estimate, state: State) -> bool:
    """Say whether failsafes act: in the air, and with rotors turning in a state that flies."""
    status = seen.status
    if status is None or (status.armed and not status.in_air):
        return state.kind.flying
    return status.in_air


def _safer(chart: Chart, state: State, to: str, *, obeyed: bool) -> bool:
    """Say whether a failsafe may lead away, `obeyed` if an earlier one wants to be here."""
    rank = _SAFETY.get(chart.states[to].kind.name, 0)
    here = _SAFETY.get(state.kind.name, 0)
    return rank > here or (rank == here == 0 and not obeyed)


def _invariant(
    state: State, memory: ChartMemory, question: Question
) -> tuple[float | None, Transition | None, tuple[str, ...]]:
    """Return since when I(s) is broken, the way out if that was too long, and the news."""
    says, verdict = _broken(state, question)
    if verdict is None:
        return None, None, ()
    now = question.seen.now
    since = now if memory.violated_since is None else memory.violated_since
    news = f"invariant of {state.name} broken: {says}; {_reason(verdict)}".rstrip("; ")
    problems = (news,) if memory.violated_since is None else ()
    if state.violated_to is None or now - since < state.tolerated - EPSILON:
        return since, None, problems
    text = f"invariant broken for {state.tolerated:g} s"
    reads = frozenset((f"I({state.name})",))
    return since, Transition(-1, state.violated_to, text, reads=reads), problems


def _reason(verdict: Verdict) -> str:
    if verdict.value is None or verdict.threshold is None:
        return verdict.why
    return f"{verdict.why} {verdict.value:.2f} against {verdict.threshold:g}".strip()


def _broken(state: State, question: Question) -> tuple[str, Verdict | None]:
    """Return the first of the kind's invariant and the mission's own that does not hold."""
    invariant = state.kind.invariant
    if invariant is not None:
        verdict = invariant.check(question.seen, state.target)
        question.answers[f"I({state.name})"] = verdict
        if verdict.holds is False:
            return invariant.says, verdict
    if state.promise is not None:
        verdict = state.promise(question)
        if verdict.holds is False:
            return "the mission's own", verdict
    return "", None


def _explained(
    chart: Chart,
    state: State,
    fired: Transition,
    outputs: tuple[Output, ...],
    question: Question,
) -> Fired:
    mode = chart.states[fired.to].kind.mode
    said = tuple(f"{output.verb} {output.text}" for output in outputs)
    asked = tuple(item for item in question.answers.items() if item[0] in fired.reads)
    return Fired(state.name, fired.to, fired.text, asked, (f"mode {mode}", *said))
