"""Soundness of the checks of charts: `python -m studies.soundness`.

Random charts are explored as `missionkit validate` does. Then the engine flies each at random: it
must never do what was called impossible. And each run that the checks found is flown by the engine:
it must happen.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from random import Random
from typing import NamedTuple

from missionkit.chart.checks.exploration.concrete_flight import Instant, Run
from missionkit.chart.checks.exploration.concrete_run import Concrete
from missionkit.chart.checks.exploration.exploration_result import Exploration
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.independent_regions import independent
from missionkit.chart.checks.exploration.requirement_proof import Proof, Standing, proofs
from missionkit.chart.checks.exploration.search import explore
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.livelocks import flown_into
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
from missionkit.plugin_containment import Containment
from studies.parallel import in_parallel
from studies.soundness_charts import (
    CATALOGUE,
    EVENTS,
    OWN_EVENTS,
    TICK,
    Seen,
    chart,
    chart_of_regions,
    estimate,
    flight,
    requirements,
)

FLIGHTS = 6  # through each chart
REGIONS = 5  # of so many charts one is made of regions, without requirements
PAGE = """# Study: what is called impossible never happens, and what can happen does

Random charts with parallel regions, timers, events, delayed events, variables, invariants and
failsafes are explored as `missionkit validate` does. The engine then flies each of them {flights}
times at random, and flies the run that the checks found to each transition that can fire.

    {command}

- Charts: {charts}, of which {complete} were explored completely, and {apart} have independent
  regions, which were explored apart.
- Random ticks: {ticks}. A transition that can never fire fired, a state that is never reached was
  reached, a tick did not come to rest although none was found, a requirement was broken that was
  proved, or fulfilled that no run can fulfil, or a run did not happen: **{contradictions}**.
- Requirements: {proved} proved, {refuted} refuted, {open} open.
- Transitions and failsafes that are not excluded: for **{shown}** the checks found a run, and the
  engine, with the guards themselves, has flown each of these runs (one that did not happen counts
  as a contradiction above, as does a run that is said to break a requirement and does not). For
  the others no run was found: nothing is claimed of them.
"""


class Judged(NamedTuple):
    """What came of one chart."""

    seed: int
    complete: bool
    apart: bool  # its regions are independent
    ticks: int
    contradictions: tuple[str, ...]
    shown: int  # transitions and failsafes with a run
    without_run: int  # those that are not excluded, without one
    standings: tuple[int, int, int]  # requirements proved, refuted, open


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


def flown(compiled: Chart, every: Sequence[Seen]) -> Flown:
    """Fly a chart, up to a tick that does not come to rest; return what it did."""
    flight = Flight(compiled)
    entered, taken = set(flight.memory.active), set()
    rested = True
    for seen in every:
        flight.now += TICK
        decision = flight.tick(seen)
        entered.update(*(move.active for move in decision.moves))
        taken.update(fired.reason.partition(",")[0] for fired in decision.fired)
        rested = not any("come to rest" in it for it in flight.contain.take())
        if not rested:  # nor will most ticks after it, each of which takes a thousand steps
            break
    return Flown(entered, taken, rested, *flight.judged())


def replayed(compiled: Chart, run: Run) -> tuple[Flight, Decision]:
    """Fly a run of the checks; return the flight and its last decision."""
    flight = Flight(compiled)
    for instant in run.instants[:-1]:
        flight.now = instant.now
        flight.tick(as_seen(instant))
    flight.contain.take()
    flight.now = run.instants[-1].now
    return flight, flight.tick(as_seen(run.instants[-1]))


def unfounded(
    compiled: Chart, concrete: Concrete, runs: Sequence[tuple[str, Run]], proved: Sequence[Proof]
) -> Iterator[str]:
    """Yield each run of the checks at whose end the engine does not do what is said.

    Args:
        compiled: the chart.
        concrete: finds runs.
        runs: to transitions and failsafes, by their names.
        proved: what is known of the requirements.
    """
    for name, run in runs:
        _, decision = replayed(compiled, run)
        if all(fired.reason.partition(",")[0] != name for fired in decision.fired):
            yield f"the run to {name} does not happen"
    for circle in concrete.explored.circles[:1]:
        into = flown_into(circle, concrete)
        if into is not None and not replayed(compiled, into)[0].contain.take():
            yield "the run to a tick that does not come to rest does not happen"
    for proof in proved:
        model = proof.requirement
        if proof.run is not None and model.existence is None and model.response is None:
            flight, _ = replayed(compiled, proof.run)
            if model.name not in flight.judged()[0]:
                yield f"the run that breaks {model.name} does not happen"


def as_seen(instant: Instant) -> Seen:
    """Return what the engine is given in one tick of a run."""
    charge: float | None = None
    flags = [GROUND_TOUCHED] if instant.point.get(TOUCHED) else []
    for quantity, value in instant.point.items():
        if quantity == CHARGE:
            charge = value
        for flag in ("a", "b"):
            if quantity.name == f"flag (name {flag})":
                flags += [f"{flag}?"] if value is None else [flag] if value else []
    failing = instant.point.get(FAILING) == 1.0
    return Seen(charge, (*flags, *instant.events), failing, instant.in_air)


def judged(seed: int) -> Judged:
    """Explore one random chart and fly it."""
    random = Random(seed)  # noqa: S311 - nothing secret
    if seed % REGIONS:
        text, known = chart(random), EVENTS
    else:
        text, known = chart_of_regions(random), (*EVENTS, *OWN_EVENTS)
    flights = [flight(random, known) for _ in range(FLIGHTS)]
    if seed % REGIONS:
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
    concrete = Concrete(explored_chart, explored)
    examples = [(_name(explored_chart, number), number) for number in explored.taken]
    examples = [it for it in examples if it[0][:1] == "t" or it[0].startswith("failsafe x")]
    tried = [(name, concrete.taking(number)) for name, number in examples]
    runs = [(name, run) for name, run in tried if run is not None]
    wrong += unfounded(compiled, concrete, runs, proved)
    ticks = sum(map(len, flights))
    known = Counter(proof.standing for proof in proved)
    standings = (known[Standing.PROVED], known[Standing.REFUTED], known[Standing.OPEN])
    apart = independent(explored_chart) is not None
    without = len(tried) - len(runs)
    return Judged(
        seed, explored.complete, apart, ticks, tuple(wrong), len(runs), without, standings
    )


def _refused(proved: Sequence[Proof], flown: Flown) -> Iterator[str]:
    """Yield each requirement that was broken although proved, or fulfilled although no run can."""
    for proof in proved:
        name = proof.requirement.name
        if proof.standing is Standing.PROVED and name in flown.broken:
            yield f"{name} broken"
        if proof.always and name in flown.fulfilled:
            yield f"{name} fulfilled"


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
    shown = sum(it.shown for it in found)
    return PAGE.format(
        flights=FLIGHTS,
        command=command,
        charts=len(found),
        complete=sum(it.complete for it in found),
        apart=sum(it.apart for it in found),
        ticks=sum(it.ticks for it in found),
        contradictions=sum(len(it.contradictions) for it in found),
        proved=sum(it.standings[0] for it in found),
        refuted=sum(it.standings[1] for it in found),
        open=sum(it.standings[2] for it in found),
        shown=_of(shown, sum(it.without_run for it in found)),
    )


def _of(shown: int, others: int) -> str:
    every = shown + others
    return f"{shown} of {every} ({100.0 * shown / max(1, every):.1f} %)"


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
