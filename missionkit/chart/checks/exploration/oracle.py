"""Guards answered by choice: each leaf guard says whatever the situation so far leaves open.

A path through one tick is a list of choices. What was chosen is kept as boxes of the quantities
that the guards read, so that no path contradicts itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from typing_extensions import override

from missionkit.chart.checks.exploration.leaf_answers import (
    ASKED_IF_TRUE,
    VERDICTS,
    Answer,
    Knowledge,
    Leaf,
    lasting,
    left,
    possible_at_entry,
)
from missionkit.chart.checks.exploration.leaf_compiler import LeafCompiler
from missionkit.chart.checks.guard_regions import GuardRegion, RegionReader
from missionkit.chart.checks.interval_boxes import (
    EVERYWHERE,
    kept_at_entry,
)
from missionkit.chart.checks.possible_places import Places
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.semantics.compiled_chart import GuardContext, GuardFunction
from missionkit.chart.semantics.guard_compiler import (
    answered,
)
from missionkit.messages import Verdict
from missionkit.messages.region import Boxes

LONG_AGO = -1e9  # s


class Choice(NamedTuple):
    """One choice: which option of how many."""

    taken: int
    options: int


class Situation:
    """One path through one tick: what was chosen so far, and what that says of the quantities."""

    def __init__(self, oracle: Oracle, plan: Sequence[Choice], age: float) -> None:
        self.oracle = oracle
        self.plan = plan
        self.planned = len(plan)
        self.choices: list[Choice] = []
        self.known = oracle.nothing
        self.age = age  # s that the commanding state has lasted at most
        self.ages: dict[str, float] = {}  # s that each state has lasted at most
        self.answers: dict[str, Verdict] = {}  # by the names of the leaves
        self.fresh = False  # the commanding state was entered in this tick
        self.before: Boxes = ()  # what was known just before that

    def pick(self, count: int) -> int:
        """Return the number of an option: as planned, beyond that the first."""
        at = len(self.choices)
        choice = self.plan[at] if at < self.planned else Choice(0, count)
        self.choices.append(choice)
        return choice.taken

    def following(self) -> list[Choice] | None:
        """Return the plan of the next path, None if this was the last."""
        plan = self.choices
        while plan and plan[-1].taken + 1 == plan[-1].options:
            plan.pop()
        if not plan:
            return None
        plan[-1] = Choice(plan[-1].taken + 1, plan[-1].options)
        return plan

    def enter(self) -> None:
        """Forget what is known only of the state that commanded before."""
        self.fresh, self.before = True, self.known.boxes
        self.answers = {}
        self.known = self.known.after(
            "entry", lambda: kept_at_entry(self.known.boxes) or EVERYWHERE
        )

    def take(self, leaf: Leaf) -> Verdict:
        """Choose what a leaf answers, among what the situation leaves open."""
        verdict = self.answers.get(leaf.name)
        if verdict is not None:
            return verdict
        possible = self._possible(leaf)
        at = self.pick(len(possible)) if len(possible) > 1 else 0
        option, self.known = possible[at] if possible else (leaf.options[0], self.known)
        verdict = self.answers[leaf.name] = VERDICTS[option]
        return verdict

    def _possible(self, leaf: Leaf) -> Sequence[tuple[Answer, Knowledge]]:
        """Return the answers that are left open, and what is known after each: worked out once."""
        age = 0.0 if self.fresh else self.age
        key = leaf.name, age >= leaf.soonest
        found = self.known.open.get(key)
        if found is None:
            every = ((each, self._after(leaf, each, age)) for each in leaf.options)
            found = self.known.open[key] = tuple((each, it) for each, it in every if it is not None)
        return found

    def _after(self, leaf: Leaf, option: Answer, age: float) -> Knowledge | None:
        if option is Answer.HOLDS and age < leaf.soonest:
            return None
        truth = leaf.at_entry if self.fresh else leaf.truth
        step = f"{option} {leaf.name}"
        known = self.known.after(step, lambda: self._noted(left(self.known.boxes, truth, option)))
        return known if known.boxes else None

    def _noted(self, boxes: Boxes) -> Boxes:
        self.oracle.work += sum(map(len, boxes))
        return self.oracle.places.possible(boxes)


class Oracle:
    """Answers the leaf guards of one chart.

    Args:
        places: of the mission: no answer contradicts where they are.
    """

    def __init__(self, places: Places) -> None:
        self.places = places
        self.nothing = Knowledge(EVERYWHERE)
        self.situation = Situation(self, (), 0.0)
        self.leaves: dict[str, Leaf] = {}
        self.work = 0  # intervals worked out so far

    def answer(self, leaf: Leaf, question: GuardContext) -> Verdict:
        """Return what a leaf says in the situation at hand."""
        situation = self.situation
        if question.seen.goal is None and not situation.fresh:
            situation.enter()
        return situation.take(leaf)


class OracleCompiler(LeafCompiler):
    """Compiles guards as the engine does, but for leaves, which an oracle answers.

    Strings that nothing assigns are leaves too: they stand for a choice before the flight.
    """

    def __init__(
        self,
        named: dict[str, ex.Expression],
        reader: RegionReader,
        oracle: Oracle,
        constants: Iterable[str],
    ) -> None:
        super().__init__(named)
        self._constants = frozenset(constants)
        self._uses: set[tuple[str, bool]] = set()  # of named guards
        self._reader = reader
        self._oracle = oracle

    @override
    def ask(self, expression: ex.Expression) -> GuardFunction:
        match expression:
            case ex.All(parts=parts):
                return _until(tuple(map(self.ask, parts)), decisive=False)
            case ex.Any(parts=parts):
                return _until(tuple(map(self.ask, parts)), decisive=True)
            case ex.VariableGuard(name=variable) if variable in self._constants:
                name = self.name(expression)
                return self._remembered(name, lambda: self._leaf(name, expression))
            case _:
                return super().ask(expression)

    @override
    def _latch(self, name: str, latch: ex.Hysteresis) -> GuardFunction:
        return self._leaf(name, latch)

    @override
    def _leaf(self, name: str, guard: ex.Expression) -> GuardFunction:
        truth = self._reader.truth(guard)
        at_entry = GuardRegion(*map(possible_at_entry, truth))
        known = isinstance(guard, ex.VariableGuard)
        leaf = Leaf(name, truth, at_entry, lasting(truth.may), known=known)
        self._oracle.leaves[name] = leaf
        answer = self._oracle.answer
        return answered(name, lambda question: answer(leaf, question))

    def use(self, guard: ex.Expression, *, if_true: bool) -> None:
        """Note what a transition or failsafe wants to know of the leaves of its guard."""
        match guard:
            case ex.Named(name=name):
                if (name, if_true) in self._uses:
                    return
                self._uses.add((name, if_true))
                named = self._named[name]
                if isinstance(named, ex.Use | ex.Hysteresis):
                    self._used(self.name(guard), if_true=if_true)
                else:
                    self.use(named, if_true=if_true)
            case ex.All(parts=parts) | ex.Any(parts=parts):
                for part in parts:
                    self.use(part, if_true=if_true)
            case ex.Not(part=part):
                self.use(part, if_true=not if_true)
            case _:
                self._used(self.name(guard), if_true=if_true)

    def use_the_rest(self) -> None:
        """Note that the leaves that nothing in the file uses are asked whether they are true."""
        for leaf in self._oracle.leaves.values():
            leaf.options = leaf.options or ASKED_IF_TRUE

    def _used(self, name: str, *, if_true: bool) -> None:
        if name in self._oracle.leaves:
            self._oracle.leaves[name].used(if_true=if_true)


def _until(parts: tuple[GuardFunction, ...], *, decisive: bool) -> GuardFunction:
    """Return Kleene's and (False decides) or or (True decides), asking no more than it needs."""

    def ask(question: GuardContext) -> Verdict:
        settled = Verdict(holds=not decisive)
        for part in parts:
            verdict = part(question)
            if verdict.holds is decisive:
                return verdict
            if verdict.holds is None:
                settled = verdict
        return settled

    return ask
