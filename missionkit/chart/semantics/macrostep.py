"""Run to completion: microsteps until the chart rests, then each event, by the SCXML algorithm.

Source: "State Chart XML (SCXML)", W3C Recommendation, 1 September 2015, appendix D:
mainEventLoop, selectTransitions, microstep.
"""

from __future__ import annotations

from collections.abc import Sequence

from missionkit.chart.semantics import entry_exit_sets
from missionkit.chart.semantics.actions_and_events import (
    assigned,
    delay_of,
    in_words,
    matches,
    scheduled,
)
from missionkit.chart.semantics.chart_memory import ChartMemory, Decision
from missionkit.chart.semantics.compiled_chart import (
    ROOT_STATE,
    Chart,
    CompiledTransition,
    GuardContext,
    Output,
    TimedTransition,
)
from missionkit.chart.semantics.configuration import configuration
from missionkit.chart.semantics.guard_evaluation import evaluated
from missionkit.chart.semantics.time_tolerance import EPSILON
from missionkit.messages import ABORT, RETURN_HOME, Action, Fired, Verdict

MOST_MICROSTEPS = 1000  # microsteps in one tick: more is a chart that does not come to rest
WATCHED_FROM = 16  # microsteps after which a tick is watched for going round in a circle
ERROR = "error.execution"
_new = tuple.__new__  # quicker than the class's own
ORDERS = frozenset((ABORT, RETURN_HOME))  # of the operator: no event of the chart


class Macrostep:
    """One tick in which something may happen."""

    __slots__ = (
        *("chart", "memory", "question", "now", "first_answers", "internal", "external", "here"),
        *("fired", "moves", "orders", "problems", "pilot_entered", "stale"),
    )

    def __init__(
        self, chart: Chart, memory: ChartMemory, question: GuardContext, problems: tuple[str, ...]
    ) -> None:
        self.chart = chart
        self.memory = memory
        self.question = question
        self.now = question.seen.now
        self.first_answers = question.answers
        self.internal: list[str] = []
        self.external: list[str] = [each for each in question.seen.events if each not in ORDERS]
        self.here = configuration(chart, memory.active)
        self.fired: list[Fired] = []
        self.moves: list[entry_exit_sets.Move] = []
        self.orders: tuple[Action, ...] = ()
        self.problems = problems
        self.pilot_entered = False
        self.stale = False  # the guards have not seen the last microstep yet

    def run(
        self, forced: CompiledTransition | None, *, rested: bool
    ) -> tuple[ChartMemory, Decision]:
        """Take the entry of the first tick, what is forced, and all that follows.

        Args:
            forced: comes before everything else; the events of this tick are then dropped.
            rested: nothing without an event is ready as yet.
        """
        if not self.memory.started:
            self._start()
            rested = False
        if forced is None:
            self._hear_delayed()
        else:
            self.external.clear()
            self._microstep((forced,))
            rested = False
        self._run_to_rest(rested=rested)
        return self.memory, _new(
            Decision,
            (
                self.first_answers,
                tuple(self.fired),
                tuple(self.moves),
                self.pilot_entered,
                self.orders,
                self.problems,
            ),
        )

    def _run_to_rest(self, *, rested: bool) -> None:
        """Take what is ready until nothing is; keep none of it if that never comes to an end."""
        before = self.memory, self.here, self.orders, self.problems, self.pilot_entered
        taken = len(self.moves), len(self.fired)
        chosen: Sequence[CompiledTransition] = ()
        seen_before: tuple[object, ...] = ()
        if not rested:
            chosen = self._selected(self.here.ways, None)
        while True:
            if not chosen:
                chosen = self._heard()
            if not chosen or self.memory.ended:
                return
            count = len(self.moves)
            if count >= MOST_MICROSTEPS or (seen_before and self._situation() == seen_before):
                break
            if count >= WATCHED_FROM and count.bit_count() == 1:
                seen_before = self._situation()
            rests = self._microstep(chosen) or not self._moving()
            chosen = () if rests else self._selected(self.here.ways, None)
        way = " -> ".join(fired.to for fired in self.fired[-6:])
        self.question.contain.note(f"the chart does not come to rest within one tick: ... {way}")
        self.memory, self.here, self.orders, self.problems, self.pilot_entered = before
        del self.moves[taken[0] :], self.fired[taken[1] :]
        self._refresh()

    def _situation(self) -> tuple[object, ...]:
        """Return all that decides how a tick goes on: seen twice, it goes round in a circle."""
        memory = self.memory
        queues = tuple(self.internal), tuple(self.external), memory.delayed
        stands = memory.active, memory.entered, memory.variables, memory.history, memory.held
        return (*stands, *queues, self.pilot_entered)

    def _moving(self) -> bool:
        """Say whether a transition without an event may be ready after a microstep."""
        if self.memory.ended:
            return False
        self._refresh()
        return self.question.frugal or evaluated(self.here, self.memory, self.question, {})

    def _heard(self) -> Sequence[CompiledTransition]:
        """Return what the next event that concerns anything leads to: internal ones first."""
        while self.internal or self.external:
            event = (self.internal or self.external).pop(0)
            chosen = self._selected(self.here.heard, event)
            if chosen:
                return chosen
        return ()

    def _hear_delayed(self) -> None:
        """Queue the delayed events that are due, before what has come from outside since."""
        delayed = self.memory.delayed
        due = [each.event for each in delayed if each.due <= self.now + EPSILON]
        if due:
            self.external[:0] = due
            self.memory = self.memory._replace(delayed=delayed[len(due) :])

    def _start(self) -> None:
        """Carry out the entry of the initial states, which are active already."""
        move = entry_exit_sets.beginning(self.chart)
        self.memory = self.memory._replace(started=True, ended=move.ended)
        self.moves.append(move)
        self.pilot_entered = True
        outputs_text = self._carried_out(self.chart.states[ROOT_STATE].initial.outputs)
        outputs_text += self._entered(move)
        self.stale = True
        if outputs_text:
            opening = CompiledTransition(-1, (self.chart.initial,), "start")
            self.fired.append(self._explained(opening, outputs_text, self.memory.state))

    def _selected(
        self, ways: tuple[tuple[TimedTransition, ...], ...], event: str | None
    ) -> Sequence[CompiledTransition]:
        """Return the transitions to take together: selectTransitions."""
        if len(ways) == 1:
            return self._first(ways[0], event)
        enabled: dict[int, CompiledTransition] = {}
        for each in ways:
            for way in each:
                transition = way[0]
                if transition.number in enabled:
                    break
                if self._enabled(way, event):
                    enabled[transition.number] = transition
                    break
        found = tuple(enabled.values())
        if len(found) < 2:
            return found
        return entry_exit_sets.without_conflicts(
            self.chart, self.memory.active, found, self.memory.history
        )

    def _first(
        self, ways: tuple[TimedTransition, ...], event: str | None
    ) -> Sequence[CompiledTransition]:
        for way in ways:
            if self._enabled(way, event):
                return (way.transition,)
        return ()

    def _enabled(self, way: TimedTransition, event: str | None) -> bool:
        transition, wait = way
        memory = self.memory
        if self.now - memory.entered[transition.source] < wait:
            return False
        if event is not None and not matches(transition.events, event):
            return False
        hold = transition.hold
        if hold and self.now - memory.held.get(transition.number, self.now) < hold - EPSILON:
            return False
        if transition.ask is None:
            return True
        if self.stale:
            self._refresh()
        return transition.ask(self.question)[0] is True

    def _refresh(self) -> None:
        """Re-evaluate the guards with the current configuration, variables and behaviour."""
        self.stale = False
        memory, question = self.memory, self.question
        seen = question.seen
        done, goal = (False, None) if self.pilot_entered else (seen.done, seen.goal)
        question.active, question.variables = memory.active, memory.variables
        question.seen = seen.standing(memory.state, memory.entered_at, done=done, goal=goal)
        question.answers = {}

    def _microstep(self, chosen: Sequence[CompiledTransition]) -> bool:
        """Exit, act, enter; say whether the chart is sure to rest after that."""
        chart, source = self.chart, self.memory.state
        move = entry_exit_sets.move(chart, self.memory.active, chosen, self.memory.history)
        if move.exited or move.entries:
            self._stand(move)
        self.moves.append(move)
        outputs_text: list[str] = []
        if move.says:
            blocks = [chart.states[name].exit for name in move.exited]
            blocks += [way.outputs for way in chosen]
            outputs_text = [text for block in blocks for text in self._carried_out(block)]
            outputs_text += self._entered(move)
        for way in chosen:
            self.fired.append(self._explained(way, outputs_text, way.source or source))
            outputs_text = []
        self.stale = True
        return not move.kept and self.here.soonest > 0.0 and not move.ended

    def _stand(self, move: entry_exit_sets.Move) -> None:
        """Put the memory where a move leads; timers of what was exited end."""
        memory = self.memory
        here = self.here = configuration(self.chart, move.active)
        if here.pilot != memory.pilot or memory.state in move.exited:
            self.pilot_entered = True
        entered = dict.fromkeys(move.active, self.now)
        for name in move.kept:
            entered[name] = memory.entered[name]
        held = memory.held
        if held:
            held = {number: since for number, since in held.items() if number not in move.gone}
        violated = memory.violated
        if violated:
            exited = move.exited
            violated = {name: since for name, since in violated.items() if name not in exited}
        history = {**memory.history, **move.history} if move.history else memory.history
        self.memory = _new(
            ChartMemory,
            (
                *(move.active, entered, memory.windows, memory.variables, here.pilot),
                *(history, held, violated, True, move.ended, memory.delayed),
                memory.monitors,
            ),
        )

    def _entered(self, move: entry_exit_sets.Move) -> list[str]:
        """Carry out what entering states says, and return it in words."""
        outputs_text: list[str] = []
        for entry in move.entries:
            for block in entry.blocks:
                outputs_text += self._carried_out(block)
            self.internal += entry.events
        return outputs_text

    def _carried_out(self, block: Sequence[Output]) -> list[str]:
        """Do what a block of outputs says, up to the first that fails; return it in words."""
        for count, output in enumerate(block, 1):
            if wrong := self._failure(output):
                rest = "" if count == len(block) else "; the actions after it are skipped"
                self.problems += (wrong + rest,)
                self.internal.append(ERROR)
                block = block[:count]
                break
        return list(map(in_words, block))

    def _failure(self, output: Output) -> str:
        """Carry out one output; return what is wrong with it, "" if nothing is."""
        wrong, memory = "", self.memory
        match output.verb:
            case "raise" if output.operation:
                wrong = self._send(output)
            case "raise":
                self.internal.append(output.text)
            case "cancel":
                kept = [each for each in memory.delayed if each.event != output.text]
                self.memory = memory._replace(delayed=tuple(kept))
            case "vehicle":
                self.orders += (Action(output.text),)
            case "assign":
                values, wrong = assigned(self.chart.variables, memory.variables, output)
                self.memory = memory._replace(variables=values)
            case _:  # what is logged stands in the record
                pass
        return wrong

    def _send(self, output: Output) -> str:
        """Put off an event; without any delay it comes after those raised inside."""
        delay, wrong = delay_of(self.memory.variables, output)
        if wrong:
            return wrong
        if delay == 0.0:
            self.external.append(output.text)
            return ""
        delayed, wrong = scheduled(self.memory.delayed, self.now + delay, output.text)
        self.memory = self.memory._replace(delayed=delayed)
        return wrong

    def _explained(
        self, way: CompiledTransition, outputs_text: Sequence[str], source: str
    ) -> Fired:
        """Return the record of a transition; one of the root is shown with the state it left."""
        verdicts: tuple[tuple[str, Verdict], ...] = ()
        if way.reads:
            now, first = self.question.answers, self.first_answers
            answers = now if all(name in now for name in way.reads) else first | now
            verdicts = tuple([(name, answers[name]) for name in way.reads if name in answers])
        to = way.to[0] if len(way.to) == 1 else ", ".join(way.to) or source
        outputs = (self.here.mode_text, *outputs_text)
        return _new(Fired, (source, to, way.text, verdicts, outputs))
