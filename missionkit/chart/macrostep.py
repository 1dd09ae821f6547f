"""Run to completion: microsteps until the chart rests, then each event, by the SCXML algorithm.

Source: "State Chart XML (SCXML)", W3C Recommendation, 1 September 2015, appendix D:
mainEventLoop, selectTransitions, microstep.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence

from missionkit.chart import tree
from missionkit.chart.compiled import ROOT, Chart, Output, Question, Stance, Transition
from missionkit.chart.memory import ChartMemory, Decision
from missionkit.chart.outputs import assigned, matches
from missionkit.chart.stance import stance
from missionkit.messages import Action, Fired, Verdict

MOST = 100  # microsteps in one tick: more is a chart that does not come to rest
ERROR = "error.execution"
EPSILON = 1e-9  # s


class Macrostep:
    """One tick in which something may happen."""

    def __init__(
        self, chart: Chart, memory: ChartMemory, question: Question, problems: tuple[str, ...]
    ) -> None:
        self.chart = chart
        self.memory = memory
        self.question = question
        self.now = question.seen.now
        self.first_answers = question.answers
        self.queue: deque[str] = deque()
        self.fired: list[Fired] = []
        self.moves: list[tree.Move] = []
        self.orders: list[Action] = []
        self.problems = list(problems)
        self.pilot_entered = False
        self.stale = False  # the guards have yet to be told of the last microstep

    def run(self, forced: Transition | None) -> tuple[ChartMemory, Decision]:
        """Take the entry of the first tick, what is forced, and all that follows."""
        if not self.memory.started:
            self._start()
        external = deque(() if forced is not None else self.question.seen.events)
        if forced is not None:
            self._microstep([forced])
        for chosen in self._steps(external):
            if len(self.moves) >= MOST:
                self._give_up()
                break
            self._microstep(chosen)
        return self.memory, Decision(
            tuple(self.first_answers.items()),
            tuple(self.fired),
            tuple(self.moves),
            self.pilot_entered,
            tuple(self.orders),
            tuple(self.problems),
        )

    def _steps(self, external: deque[str]) -> Iterator[list[Transition]]:
        """Yield what to take next: without an event, for an internal one, for an external one."""
        while not self.memory.ended:
            chosen = self._selected(None)
            while not chosen and (self.queue or external):
                chosen = self._selected((self.queue or external).popleft())
            if not chosen:
                return
            yield chosen

    def _give_up(self) -> None:
        way = " -> ".join(fired.to for fired in self.fired[-6:])
        self.question.contain.note(f"the chart does not come to rest: ... {way}")

    def _start(self) -> None:
        """Carry out the entry of the initial states, which are active already."""
        move = tree.beginning(self.chart)
        root = self.chart.states[ROOT].initial.outputs
        outputs = [*root, *(each for entry in move.entries for each in entry.outputs)]
        self.memory = self.memory._replace(started=True, ended=move.ended)
        self.moves.append(move)
        self.pilot_entered = True
        events = [event for entry in move.entries for event in entry.events]
        said = self._carried_out(outputs)
        if said:
            initial = self.chart.initial
            opening = Transition(-1, (initial,), "start", source=self.memory.state)
            self.fired.append(self._explained(opening, said))
        self.queue += events

    def _selected(self, event: str | None) -> list[Transition]:
        """Return the transitions to take together: selectTransitions."""
        here = self._here()
        enabled: dict[int, Transition] = {}
        for ways in here.ways:
            for way in ways:
                if way.number in enabled:
                    break
                if self._enabled(way, event):
                    enabled[way.number] = way
                    break
        found = list(enabled.values())
        if len(found) < 2:
            return found
        return tree.without_conflicts(self.chart, self.memory.active, found, self.memory.history)

    def _enabled(self, way: Transition, event: str | None) -> bool:
        heard = not way.events if event is None else matches(way.events, event)
        if not heard or not self._in_time(way):
            return False
        if way.ask is None:
            return True
        if self.stale:
            self._refresh()
        return way.ask(self.question).holds is True

    def _in_time(self, way: Transition) -> bool:
        memory, now = self.memory, self.now
        here = now - memory.entered[way.source] + EPSILON
        if way.patient and here < self.chart.states[way.source].dwell:
            return False
        if way.after is not None and here < way.after:
            return False
        return not way.hold or now - memory.held.get(way.number, now) >= way.hold - EPSILON

    def _refresh(self) -> None:
        """Ask the guards anew, with the configuration, variables and behaviour as they are now."""
        self.stale = False
        memory, seen = self.memory, self.question.seen
        state, entered_at = memory.state, memory.entered_at
        self.question.active = memory.active
        self.question.variables = memory.variables
        self.question.seen = (
            seen._replace(state=state, entered_at=entered_at, done=False, goal=None)
            if self.pilot_entered
            else seen._replace(state=state, entered_at=entered_at)
        )
        self.question.answers = {}

    def _microstep(self, chosen: Sequence[Transition]) -> None:
        """Exit, act, enter."""
        chart, memory = self.chart, self.memory
        move = tree.move(chart, memory.active, chosen, memory.history)
        if move.exited or move.entries:
            self._stand(move)
        self.moves.append(move)
        outputs = [each for name in move.exited for each in chart.states[name].exit]
        outputs += [each for way in chosen for each in way.outputs]
        said = list(self._carried_out(outputs))
        for entry in move.entries:
            said += self._carried_out(entry.outputs)
            self.queue += entry.events
        self.stale = True
        for way in chosen:
            source = memory.state if way.source == ROOT else way.source
            told = self._explained(way._replace(source=source), said)
            self.fired.append(told)
            said = []

    def _stand(self, move: tree.Move) -> None:
        """Put the memory where a move leads; timers of what was exited end."""
        chart, memory = self.chart, self.memory
        entered = {name: memory.entered.get(name, self.now) for name in move.active}
        entered |= dict.fromkeys((entry.name for entry in move.entries), self.now)
        held = memory.held
        if held:
            gone = {way.number for name in move.exited for way in chart.states[name].transitions}
            held = {number: since for number, since in held.items() if number not in gone}
        violated = memory.violated
        if violated:
            kept = violated.keys() - move.exited
            violated = {name: since for name, since in violated.items() if name in kept}
        pilot = _here(chart, move.active).pilot
        exited = pilot in move.exited or memory.state in move.exited
        self.pilot_entered |= pilot != memory.pilot or exited
        self.memory = memory._replace(
            active=move.active,
            entered=entered,
            pilot=pilot,
            history={**memory.history, **move.history} if move.history else memory.history,
            held=held,
            violated=violated,
            ended=move.ended,
        )

    def _here(self) -> Stance:
        return _here(self.chart, self.memory.active)

    def _carried_out(self, outputs: Iterable[Output]) -> list[str]:
        """Do what outputs say, and return it in words."""
        said = []
        for output in outputs:
            said.append(f"{output.verb} {output.text}{_operation(output)}")
            if output.verb == "raise":
                self.queue.append(output.text)
            elif output.verb == "vehicle":
                self.orders.append(Action(output.text))
            elif output.verb == "assign":
                self._assign(output)
        return said

    def _assign(self, output: Output) -> None:
        values, wrong = assigned(self.chart.variables, self.memory.variables, output)
        self.memory = self.memory._replace(variables=values)
        if wrong:
            self.problems.append(wrong)
            self.queue.append(ERROR)

    def _explained(self, way: Transition, said: Sequence[str]) -> Fired:
        answers = self.first_answers | self.question.answers
        asked: tuple[tuple[str, Verdict], ...] = tuple(
            [item for item in answers.items() if item[0] in way.reads] if way.reads else []
        )
        to = ", ".join(way.to) or way.source
        return Fired(way.source, to, way.text, asked, (f"mode {self._here().mode}", *said))


def _here(chart: Chart, active: tuple[str, ...]) -> Stance:
    return chart.stances.get(active) or stance(chart, active)


def _operation(output: Output) -> str:
    match output.operation:
        case "":
            return ""
        case "set":
            return f" = {output.operand}"
        case "toggle":
            return " toggled"
        case operation:
            return f" {operation} {output.operand}"
