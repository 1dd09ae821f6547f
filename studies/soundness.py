"""Soundness of the checks of charts: `python -m studies.soundness`.

Random charts are explored as `missionkit validate` does. Then the engine flies each at random: it
must never do what was called impossible. And the example of each transition that can fire is flown
by the engine: it must happen.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from random import Random
from typing import NamedTuple

from missionkit.chart.checks.counterexample_text import point
from missionkit.chart.checks.exploration.exploration_result import Example, Exploration, Node
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.requirement_proof import Proof, Standing, proofs
from missionkit.chart.checks.exploration.search import explore
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.load import parse
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.requirement_watch import results
from missionkit.chart.semantics.step import Decision, begin, decide
from missionkit.guards.battery import CHARGE
from missionkit.guards.ground_touched import TOUCHED
from missionkit.guards.plugin_failure import FAILING
from missionkit.messages import GROUND_TOUCHED
from missionkit.messages.region import Box, Boxes, Quantity
from missionkit.plugin_containment import Containment
from studies.parallel import in_parallel
from studies.soundness_charts import CATALOGUE, TICK, Seen, chart, estimate, flight, requirements

INSISTENCE = 130  # ticks: the built-in failsafes wait for 6 s at most
FLIGHTS = 6  # through each chart
PAGE = """# Study: what is called impossible never happens, and what can happen does

Random charts with parallel regions, timers, events, delayed events, variables, invariants and
failsafes are explored as `missionkit validate` does. The engine then flies each of them {flights}
times at random, and flies the example of each transition that the exploration says can fire.

    {command}

- Charts: {charts}, of which {complete} were explored completely.
- Random ticks: {ticks}. A transition that can never fire fired, a state that is never reached was
  reached, a tick did not come to rest although none was found, or a requirement was broken that
  was proved, or fulfilled that no run can fulfil: **{contradictions}**.
- Requirements: {proved} proved, {refuted} refuted, {open} open.
- Examples of transitions and failsafes that need nothing of what guards remember:
  **{plain}** happened when the engine flew them. One known reason for the others: states entered
  at different times have ages that the exploration keeps as intervals of their own.
- Examples that need a latch that is set, or a guard that has held for a while:
  **{past}** happened. The exploration lets what a guard remembers be anything that the guard
  allows, so that not every example of these is a run.
"""


class Judged(NamedTuple):
    """What came of one chart."""

    seed: int
    complete: bool
    ticks: int
    contradictions: tuple[str, ...]
    happened: tuple[int, int]  # examples: without a past, with one
    standings: tuple[int, int, int]  # requirements proved, refuted, open
    missed: tuple[int, int]  # the same, of those that did not happen


class Flown(NamedTuple):
    """What one flight did."""

    entered: set[str]
    taken: set[str]
    rested: bool
    broken: set[str]  # requirements
    fulfilled: set[str]


class Flight:
    """Steps the engine through a chart."""

    def __init__(self, compiled: Chart) -> None:
        self.compiled = compiled
        self.memory = begin(compiled, 0.0)
        self.contain = Containment()
        self.now = 0.0

    def tick(self, seen: Seen) -> Decision:
        """Take one tick at the current time."""
        memory = self.memory
        given = estimate(seen, self.now, memory.state, memory.entered_at)
        self.memory, decision = decide(self.compiled, memory, given, self.contain)
        return decision

    def judged(self) -> tuple[set[str], set[str]]:
        """Return the names of the requirements that are broken, and of those that are fulfilled."""
        watched, monitors = self.compiled.watch.requirements, self.memory.monitors
        every = results(watched, monitors, over=False)
        return tuple({it.name for it in every if it.fulfilled is end} for end in (False, True))

    def age(self, name: str) -> float:
        """Return how long (s) a state has been active."""
        return self.now - self.memory.entered[name]


def flown(compiled: Chart, every: Sequence[Seen]) -> Flown:
    """Fly a chart; return the states entered, the transitions taken, and whether it rested."""
    flight = Flight(compiled)
    entered, taken = set(flight.memory.active), set()
    for seen in every:
        flight.now += TICK
        decision = flight.tick(seen)
        entered.update(*(move.active for move in decision.moves))
        taken.update(fired.reason.partition(",")[0] for fired in decision.fired)
    rested = not any("come to rest" in it for it in flight.contain.take())
    return Flown(entered, taken, rested, *flight.judged())


def happens(compiled: Chart, explored: Exploration, example: Example, name: str) -> bool:
    """Say whether the engine does what an example says, its times and situations made concrete."""
    flight = _led(compiled, explored, example.node)
    if flight is None:
        return False
    seen = concrete(example.step.boxes, example.step.events)
    return any(name in _names(decision) for decision in _insisting(flight, seen))


def _led(compiled: Chart, explored: Exploration, node: Node) -> Flight | None:
    """Return a flight that has come to a node, None if it does not come there."""
    path = [node]
    while path[-1].before is not None:
        path.append(path[-1].before)
    path.reverse()
    flight = Flight(compiled)
    for before, following in pairwise(path):
        step = following.step
        if step is None:
            return None
        if not step.taken and not step.events and not step.forced:
            if not _waited(flight, following, explored.rests.get(before.number, ({},))):
                return None
        elif not _reached(flight, following, concrete(step.boxes, step.events)):
            return None
    return flight


def _reached(flight: Flight, following: Node, seen: Seen) -> bool:
    return any(flight.memory.active == following.memory.active for _ in _insisting(flight, seen))


def _insisting(flight: Flight, seen: Seen) -> Iterator[Decision]:
    """Tick with the same situation until something happens, for guards that must hold a while."""
    for _ in range(INSISTENCE):
        decision = flight.tick(seen)
        yield decision
        flight.now += TICK
        if decision.fired and decision.fired[-1].reason != "start":
            return


def _waited(flight: Flight, later: Node, rests: Boxes) -> bool:
    """Let time pass, with ticks in which nothing is to happen, until ages are as in a node.

    Args:
        flight: so far.
        later: the node with the ages.
        rests: a situation in which nothing happens.
    """
    if not set(later.ages) <= set(flight.memory.active):
        return False
    need = max((age.low - flight.age(name) for name, age in later.ages.items()), default=0.0)
    until = flight.now + max(need, 0.0)
    while flight.now + TICK < until:
        flight.tick(concrete(rests, ()))
        flight.now += TICK
    flight.now = max(flight.now, until)
    return flight.memory.active == later.memory.active


def _names(decision: Decision) -> set[str]:
    return {fired.reason.partition(",")[0] for fired in decision.fired}


def concrete(boxes: Boxes, events: tuple[str, ...]) -> Seen:
    """Return one situation of some boxes."""
    box = min(boxes, key=lambda box: (None in box.values(), len(box)), default={})
    charge: float | None = 0.9
    flags = [GROUND_TOUCHED] if _true(box, TOUCHED) else []
    for quantity, span in box.items():
        if quantity == CHARGE:
            charge = None if span is None else point(quantity, span)
        for flag in ("a", "b"):
            if quantity.name == f"flag (name {flag})":
                flags += [f"{flag}?"] if span is None else [flag] if span.low else []
    return Seen(charge, (*flags, *events), _true(box, FAILING))


def _true(box: Box, quantity: Quantity) -> bool:
    span = box.get(quantity)
    return span is not None and span.low == 1.0


def judged(seed: int) -> Judged:
    """Explore one random chart and fly it."""
    random = Random(seed)  # noqa: S311 - nothing secret
    text = chart(random)
    flights = [flight(random) for _ in range(FLIGHTS)]
    text = "\n".join((text, *requirements(random)))
    mission = parse(text, "m.yaml", CATALOGUE)
    catalogue = CATALOGUE.flying(mission.vehicle.use)
    explored_chart = ExploredChart(AnalysedChart(fulfilled(mission, catalogue), catalogue))
    explored = explore(explored_chart)
    compiled = compile_mission(mission, CATALOGUE)
    proved = list(proofs(explored_chart, explored))
    wrong: list[str] = []
    if explored.complete:
        names = {_name(explored_chart, number) for number in explored.taken}
        for one in (flown(compiled, seen) for seen in flights):
            wrong += [*_contradictions(explored, names, one), *_refused(proved, one)]
    examples = {_name(explored_chart, number): it for number, it in explored.taken.items()}
    examples = {n: it for n, it in examples.items() if n[:1] == "t" or n.startswith("failsafe x")}
    examples = {name: it for name, it in examples.items() if not it.undone}
    counted = Counter(
        (_has_past(compiled, it), happens(compiled, explored, it, name))
        for name, it in examples.items()
    )
    happened, missed = ((counted[False, it], counted[True, it]) for it in (True, False))
    ticks = sum(map(len, flights))
    known = Counter(proof.standing for proof in proved)
    standings = (known[Standing.PROVED], known[Standing.REFUTED], known[Standing.OPEN])
    return Judged(seed, explored.complete, ticks, tuple(wrong), happened, standings, missed)


def _refused(proved: Sequence[Proof], flown: Flown) -> Iterator[str]:
    """Yield each requirement that was broken although proved, or fulfilled although no run can."""
    for proof in proved:
        name = proof.requirement.name
        if proof.standing is Standing.PROVED and name in flown.broken:
            yield f"{name} broken"
        if proof.always and name in flown.fulfilled:
            yield f"{name} fulfilled"


def _has_past(compiled: Chart, example: Example) -> bool:
    """Say whether a run needs what guards remember: a latch, or how long they have held."""
    holding = {way.number for way in compiled.failsafes if way.hold}
    holding |= {way.number for it in compiled.states.values() for way in it.transitions if way.hold}
    node: Node | None = example.node
    steps = [example.step]
    while node is not None and node.step is not None:
        steps.append(node.step)
        node = node.before
    latched = any("until" in it.name for step in steps for box in step.boxes for it in box)
    return latched or any(not holding.isdisjoint(step.taken) for step in steps)


def _name(explored_chart: ExploredChart, number: int) -> str:
    if number in explored_chart.failsafes:
        return explored_chart.failsafes[number]
    return explored_chart.ways[number].model.name or ""


def _contradictions(explored: Exploration, names: set[str], flown: Flown) -> Iterator[str]:
    yield from (f"{name} fired" for name in flown.taken if name[:1] == "t" and name not in names)
    yield from (f"{name} reached" for name in flown.entered if name not in explored.reached)
    if not flown.rested and not explored.circles:
        yield "did not come to rest"


def page(found: Sequence[Judged], command: str) -> str:
    """Return the page of the study."""
    plain, past = (
        (sum(it.happened[n] for it in found), sum(it.missed[n] for it in found)) for n in (0, 1)
    )
    return PAGE.format(
        flights=FLIGHTS,
        command=command,
        charts=len(found),
        complete=sum(it.complete for it in found),
        ticks=sum(it.ticks for it in found),
        contradictions=sum(len(it.contradictions) for it in found),
        proved=sum(it.standings[0] for it in found),
        refuted=sum(it.standings[1] for it in found),
        open=sum(it.standings[2] for it in found),
        plain=_of(*plain),
        past=_of(*past),
    )


def _of(happened: int, missed: int) -> str:
    every = happened + missed
    return f"{happened} of {every} ({100.0 * happened / max(1, every):.1f} %)"


def main(arguments: Sequence[str]) -> None:
    """Run the study and print its page."""
    parser = argparse.ArgumentParser(prog="studies.soundness")
    parser.add_argument("--charts", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    wanted = parser.parse_args(arguments)
    seeds = range(wanted.first, wanted.first + wanted.charts)
    found = []
    for one in in_parallel(judged, seeds, wanted.workers, 20):
        found.append(one)
        if one.contradictions:
            print(one, file=sys.stderr)  # noqa: T201
    command = f"python -m studies.soundness --charts {wanted.charts} --first {wanted.first}"
    print(page(found, command))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])
