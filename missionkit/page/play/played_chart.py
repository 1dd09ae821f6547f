"""A chart flown by hand: the engine's own step, its guards answered by values that are set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from missionkit.chart.checks.exploration.point_guards import (
    Point,
    World,
    point_chart,
)
from missionkit.chart.checks.exploration.search import IN_AIR
from missionkit.chart.checks.guard_regions import is_endless
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.permanent_losses import Loss, losses
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.chart_memory import begin
from missionkit.chart.semantics.compiled_chart import GuardContext
from missionkit.chart.semantics.configuration import configuration
from missionkit.chart.semantics.quick_step import decide
from missionkit.geometry import IDENTITY, vec
from missionkit.guards.battery import CHARGE
from missionkit.messages import (
    Battery,
    Command,
    Estimate,
    Goal,
    Health,
    Observation,
    Record,
    Verdict,
)
from missionkit.messages.region import Quantity
from missionkit.page.play.quantities import (
    Slider,
    candidates,
    sliders,
    threshold_of,
)
from missionkit.plugin_containment import Containment

DANGER_WEIGHT = 10  # a failsafe that holds at the start counts as so many guards
LANDED_AFTER = 5.0  # s in a landing state
NOWHERE = Estimate(
    0.0,
    vec(0.0, 0.0, 0.0),
    vec(0.0, 0.0, 0.0),
    IDENTITY,
    vec(0.0, 0.0, 0.0),
    Health(aligned=True, diverged=False, gnss_at=None, vision_at=None, position_sd=0.0, rejected=0),
)


class PlayedChart:
    """A chart, where it stands, and what its guards see.

    Args:
        mission: as it was loaded.
        catalogue: with which it was loaded.
        period: s of a tick.
    """

    def __init__(self, mission: Mission, catalogue: Catalogue, period: float) -> None:
        catalogue = catalogue.flying(mission.vehicle.use)
        analysed = AnalysedChart(fulfilled(mission, catalogue), catalogue)
        self._world = World()
        self.chart, self._guards = point_chart(analysed, self._world)
        self.sliders = {it.name: it for it in sliders(self._guards)}
        self._losses = {it.name: it for it in losses(analysed) if self._concerns(it)}
        self.period = period
        self._calm = self._calm_point()
        self.reset()

    def reset(self) -> None:
        """Begin again, with everything in order."""
        self.point: dict[Quantity, float | None] = dict(self._calm)
        self.faults: dict[str, dict[Quantity, float | None]] = {}  # what it was before each
        self._memory = begin(self.chart, 0.0)
        self._count = 0
        self._in_air = False

    def _concerns(self, loss: Loss) -> bool:
        known = {it.quantity for it in self.sliders.values()}
        return any(quantity in known for quantity in loss.box)

    @property
    def losses(self) -> tuple[str, ...]:
        """What can be lost."""
        return tuple(self._losses)

    def set(self, name: str, value: float | None) -> None:
        """Set a quantity; None: it is not known."""
        slider = self.sliders[name]
        self.point[slider.quantity] = None if value is None else slider.value(value)

    def toggle(self, name: str) -> None:
        """Lose something, or have it back."""
        if name in self.faults:
            self.point |= self.faults.pop(name)
            return
        box = self._losses[name].box
        changed: dict[Quantity, float | None] = {}
        for slider in self.sliders.values():
            if slider.quantity in box:
                span = box[slider.quantity]
                changed[slider.quantity] = None if span is None else slider.value(span.low)
        self.faults[name] = {quantity: self.point.get(quantity) for quantity in changed}
        self.point |= changed

    def tick(self, events: tuple[str, ...] = ()) -> tuple[Record, Observation]:
        """Take one tick; events come with it."""
        self._count += 1
        now = self._count * self.period
        seen = self._seen(now, events)
        self._world.point = self.point
        contain = Containment()
        memory, decision = decide(self.chart, self._memory, seen, contain)
        self._memory = memory
        if decision.entered:
            self._forget()
        here = configuration(self.chart, memory.active)
        self._in_air = here.flying and not self._landed(now, here.safety)
        record = Record(
            now=now,
            state=memory.state,
            active=memory.active,
            mode=here.mode,
            verdicts=tuple(self._answers(decision.answers)),
            fired=decision.fired,
            command=Command(),
            step_note="",
            problems=(*decision.problems, *map(str, contain.failures)),
            estimate=seen.standing(memory.state, memory.entered_at, done=seen.done),
        )
        return record, Observation(now, events=events, status=seen.status)

    def _forget(self) -> None:
        """Let what is known of one state alone be as at its entry."""
        for quantity in self.point:
            if quantity.at_entry != "kept":
                self.point[quantity] = self._calm[quantity]

    def _landed(self, now: float, safety: int) -> bool:
        return safety > 1 and now - self._memory.entered_at > LANDED_AFTER

    def _seen(self, now: float, events: tuple[str, ...]) -> Estimate:
        memory, charge = self._memory, self.point.get(CHARGE)
        behavior = self.chart.states[memory.state].behavior
        finishes = behavior is not None and not is_endless(behavior)
        return NOWHERE._replace(
            now=now,
            state=memory.state,
            entered_at=memory.entered_at,
            done=finishes and memory.started,
            goal=Goal(NOWHERE.position, None, now),
            events=events,
            battery=None if charge is None else Battery(now, charge, 0.0),
            status=IN_AIR._replace(at=now, in_air=self._in_air, armed=self._in_air),
        )

    def _answers(self, answers: Mapping[str, Verdict]) -> Iterator[tuple[str, Verdict]]:
        """Yield the answers with thresholds and margins where a guard compares one quantity."""
        for name, verdict in answers.items():
            guard = self._guards.get(name)
            threshold = None if guard is None else threshold_of(guard, verdict.value)
            if threshold is None or verdict.value is None:
                yield name, verdict
                continue
            off = abs(verdict.value - threshold)
            margin = off if verdict.holds else -off
            yield name, verdict._replace(threshold=threshold, margin=margin)

    def _calm_point(self) -> dict[Quantity, float | None]:
        """Return values at which little happens: no failsafe if possible, and few transitions."""
        chosen: dict[Quantity, float | None] = {}
        for slider in self.sliders.values():
            stir = partial(self._stir, chosen, slider)
            chosen[slider.quantity] = min(candidates(slider), key=stir)
        return chosen

    def _stir(self, chosen: Point, slider: Slider, value: float) -> int:
        """Return how much happens at a value of a quantity."""
        self._world.point = {**chosen, slider.quantity: value}
        windows = [slot.begin() for slot in self.chart.slots]
        variables = {name: it.initial for name, it in self.chart.variables.items()}
        question = GuardContext(NOWHERE._replace(done=True), windows, Containment(), (), variables)
        failsafes = [it.ask(question).holds for it in self.chart.failsafes if it.ask is not None]
        ways = [it for state in self.chart.states.values() for it in state.transitions]
        taken = [it.ask(question).holds for it in ways if it.ask is not None]
        return DANGER_WEIGHT * failsafes.count(True) + failsafes.count(None) + taken.count(True)
