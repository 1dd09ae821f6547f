"""From the model of a mission to the chart that the tick steps."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import cast

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Act, Assign, Cancel, Log, Order, Raise
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import Placed, around, firsts
from missionkit.chart.model.requirements import Requirement
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.model.state_definitions import GROUP_KIND, Failsafe
from missionkit.chart.model.state_definitions import Start as StartModel
from missionkit.chart.model.state_definitions import State as StateModel
from missionkit.chart.model.state_definitions import Transition as TransitionModel
from missionkit.chart.model.variable_parameters import with_values
from missionkit.chart.model.variables import Value
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.compiled_chart import (
    ROOT_STATE,
    Chart,
    CompiledState,
    CompiledTransition,
    DefaultEntry,
    GuardFunction,
    Output,
    Shape,
    Watch,
)
from missionkit.chart.semantics.guard_compiler import GuardCompiler
from missionkit.chart.semantics.requirement_watch import PREFIX, WatchedRequirement
from missionkit.chart.semantics.robustness import Formula, formula, leaves, opened_up
from missionkit.errors import NO_PLACE
from missionkit.messages import CameraModel
from missionkit.plugin import Behavior, Plugin
from missionkit.plugin_containment import is_foreign
from missionkit.plugin_protocols import BehaviorProtocol

PLUGIN_FAILURE_TOLERANCE = 3.0  # s a plug-in may misbehave before the vehicle goes home
STUCK_FOR_GOOD = 6.0  # s before it lands


def compile_mission(mission: Mission, catalogue: Catalogue) -> Chart:
    """Compile a mission that was loaded without problems.

    The contracts of the state kinds are carried out first: default failsafes and, where one of
    them needs it, a hover state.
    """
    mission = fulfilled(mission, catalogue)
    asker = GuardCompiler(dict(mission.guards), _camera(mission))
    return compile_with(asker, mission, catalogue.flying(mission.vehicle.use))


def compile_with(asker: GuardCompiler, mission: Mission, catalogue: Catalogue) -> Chart:
    """Compile a mission whose contracts are carried out already.

    Args:
        asker: compiles its guards.
        mission: to compile.
        catalogue: of the vehicle that flies it.
    """
    return _Compiler(mission, catalogue, asker).chart()


class _Compiler:
    def __init__(self, mission: Mission, catalogue: Catalogue, asker: GuardCompiler) -> None:
        self.mission = mission
        self.catalogue = catalogue
        self.placed = {placed.name: placed for placed in mission.walk()}
        self.asker = asker
        self.with_history = {
            placed.parent for placed in self.placed.values() if placed.state.history is not None
        }
        self.firsts = firsts(self.placed)
        self.count = 0

    def chart(self) -> Chart:
        states = {ROOT_STATE: self._root()}
        for order, placed in enumerate(self.placed.values(), 1):
            states[placed.name] = self._state(placed, order)
        land = self.firsts.get("land", "")
        failsafes = (
            *map(self._failsafe, self.mission.failsafes),
            *self._touched(land),
            *self._stuck(land),
        )
        watch = self._watch()
        return Chart(
            initial=self.mission.initial.to[0],
            states=states,
            failsafes=failsafes,
            slots=tuple(self.asker.slots),  # all guards are compiled by now
            land=land,
            home=self.firsts.get("return", ""),
            variables=self.mission.variables,
            watch=watch,
            configurations={},
            moves={},
        )

    def _root(self) -> CompiledState:
        return CompiledState(
            name=ROOT_STATE,
            kind=self.catalogue.kinds[GROUP_KIND],
            behavior=None,
            target=None,
            dwell=0.0,
            shape=Shape.COMPOUND,
            children=tuple(self.mission.states),
            initial=_start(self.mission.initial),
        )

    def _behavior(self, plugin: BehaviorProtocol) -> BehaviorProtocol:
        """Return the behaviour as it flies with the mission's camera."""
        if not isinstance(plugin, Behavior) or is_foreign(plugin):
            return plugin
        return plugin.with_camera(self.mission.camera.model())

    def _with_values(
        self, state: StateModel
    ) -> Callable[[tuple[Value, ...]], BehaviorProtocol] | None:
        """Return what makes the behaviour of a state with the values of its variables."""
        use = state.behavior
        if use is None or not isinstance(use.plugin, Plugin):
            return None
        plugin, names = use.plugin, [name for name, _ in use.variables]

        def made(values: tuple[Value, ...]) -> BehaviorProtocol:
            varied = with_values(plugin, dict(zip(names, values, strict=True)))
            return self._behavior(cast(BehaviorProtocol, varied))

        return lru_cache(16)(made)

    def _state(self, placed: Placed, order: int) -> CompiledState:
        name, state, parent = placed
        kind = self.catalogue.kinds[state.kind]
        behavior = None if state.behavior is None else self._behavior(state.behavior.plugin)
        given = () if state.behavior is None else state.behavior.variables
        targets = () if behavior is None else behavior.targets()
        promise = state.invariant.holds
        ancestors = (*around(self.placed, parent), ROOT_STATE)
        return CompiledState(
            name=name,
            kind=kind,
            behavior=behavior,
            given_by=tuple([variable for _, variable in given]),
            with_values=self._with_values(state) if given else None,
            target=targets[0] if targets else None,
            dwell=self.mission.dwell if state.dwell is None else state.dwell,
            transitions=tuple([self._transition(one, placed) for one in state.transitions]),
            entry=_outputs(state.entry),
            exit=_outputs(state.exit),
            violated_to=state.invariant.exit,
            tolerated=kind.invariant.tolerated if kind.invariant is not None else 0.0,
            promise=None if promise is None else self.asker.ask(promise),
            shape=_shape(state),
            order=order,
            parent=parent or ROOT_STATE,
            ancestors=ancestors,
            children=tuple(state.states),
            initial=_start(state.initial or state.default),
            remembered=not self.with_history.isdisjoint((name, *ancestors)),
        )

    def _transition(self, model: TransitionModel, source: Placed) -> CompiledTransition:
        when = None if model.when is None else _of_source(model.when, source)
        return CompiledTransition(
            number=self._next(),
            to=model.targets,
            text=_text(model, when),
            source=source.name,
            ask=None if when is None else self.asker.ask(when),
            hold=model.for_,
            after=model.after,
            events=tuple(map(_descriptor, model.event or ())),
            outputs=_outputs(model.do),
            patient=not (model.emergency or model.event),
            internal=model.internal,
            reads=() if when is None else self._names(when),
            guard=None if when is None else self.asker.asked(when),
            default=model.name is not None and not model.place().file,
        )

    def _failsafe(self, model: Failsafe) -> CompiledTransition:
        return CompiledTransition(
            number=self._next(),
            to=(model.to,),
            text=f"failsafe {model.name}",
            ask=self.asker.ask(model.when),
            hold=model.for_,
            outputs=_outputs(model.do),
            unknown_takes=model.unknown == "take",
            reads=self._names(model.when),
            guard=self.asker.asked(model.when, unknown_takes=model.unknown == "take"),
        )

    def _touched(self, land: str) -> tuple[CompiledTransition, ...]:
        """Return what happens when the ground is touched outside landing and take-off."""
        guard: ex.Expression = ex.Use(
            "ground_touched", self.catalogue.group("guards")["ground_touched"](), NO_PLACE
        )
        touched = CompiledTransition(
            number=self._next(),
            to=(land,),
            text="failsafe ground touched",
            ask=self.asker.ask(guard),
            reads=self._names(guard),
            guard=self.asker.asked(guard),
        )
        return (touched,) if land else ()

    def _stuck(self, land: str) -> tuple[CompiledTransition, ...]:
        """Return what happens when plug-ins keep failing, after the mission's own failsafes."""
        plugin = self.catalogue.group("guards")["plugin_failed"]()
        guard: ex.Expression = ex.Use("plugin_failed", plugin, NO_PLACE)
        ask: GuardFunction = self.asker.ask(guard)
        asked = self.asker.asked(guard)
        home = self.firsts.get("return", land)
        return tuple(
            CompiledTransition(
                number=self._next(),
                to=(to,),
                text="failsafe plug-in failed",
                ask=ask,
                hold=hold,
                reads=self._names(guard),
                guard=asked,
            )
            for to, hold in ((home, PLUGIN_FAILURE_TOLERANCE), (land, STUCK_FOR_GOOD))
            if to
        )

    def _watch(self) -> Watch:
        every = self.mission.requirements
        asked = {
            self.leaf(leaf): leaf
            for requirement in every
            for moment in requirement.moments()
            for leaf in leaves(opened_up(moment, self.mission.guards))
        }
        entries = [(name, it.state) for name, it in asked.items() if isinstance(it, ex.Enter)]
        states = [(name, it.state) for name, it in asked.items() if isinstance(it, ex.In)]
        guards = [
            (name, self.asker.ask(it)) for name, it in asked.items() if not isinstance(it, ex.Enter)
        ]
        compiled = tuple(map(self._requirement, every))
        return Watch(compiled, tuple(guards), tuple(entries), tuple(states))

    def leaf(self, it: ex.Expression | ex.Enter) -> str:
        """Return what the record calls the answer of a guard, or the entry of a state."""
        return f"enter {it.state}" if isinstance(it, ex.Enter) else self.asker.name(it)

    def _requirement(self, model: Requirement) -> WatchedRequirement:
        def compiled(it: ex.Expression | ex.Enter | None) -> Formula | None:
            if it is None:
                return None
            return formula(opened_up(it, self.mission.guards), self.leaf)

        response, precedes = model.response, model.precedence is not None
        called = None if response is None else response.when
        wanted = model.never or model.always or model.existence or model.precedence
        main = compiled(wanted if response is None else response.then)
        assert main is not None  # noqa: S101 - a requirement has one pattern
        return WatchedRequirement(
            name=model.name,
            label=f"{PREFIX}{model.name}",
            pattern=model.pattern,
            limit=model.limit,
            wanted=main,
            called=compiled(model.before if precedes else called),
            during=compiled(model.while_),
            opens=compiled(model.after),
            closes=None if precedes else compiled(model.before),
            to=None if model.broken is None else model.broken.to,
            tolerated=0.0 if model.broken is None else model.broken.after,
        )

    def _next(self) -> int:
        self.count += 1
        return self.count

    def _names(self, expression: ex.Expression) -> tuple[str, ...]:
        """Return the names in the record of the guards in an expression."""
        match expression:
            case ex.All(parts=parts) | ex.Any(parts=parts):
                return tuple(dict.fromkeys(name for part in parts for name in self._names(part)))
            case ex.Not(part=part):
                return self._names(part)
            case _:
                return (self.asker.name(expression),)


def _of_source(when: ex.Expression, source: Placed) -> ex.Expression:
    """Return a guard in which `done` means the states inside `source`, if it has any."""
    if not source.state.states:
        return when

    def replaced(expression: ex.Expression) -> ex.Expression:
        match expression:
            case ex.Use(kind="done", place=place):
                return ex.Finished(source.name, _finals(source.state), place)
            case ex.All(parts=parts, place=place):
                return ex.All(tuple(map(replaced, parts)), place)
            case ex.Any(parts=parts, place=place):
                return ex.Any(tuple(map(replaced, parts)), place)
            case ex.Not(part=part, place=place):
                return ex.Not(replaced(part), place)
            case _:
                return expression

    return replaced(when)


def _finals(state: StateModel) -> tuple[tuple[str, ...], ...]:
    """Return groups of final states: the state is done when one of each group is active."""
    if not state.parallel:
        return (tuple([name for name, inner in state.states.items() if inner.final]),)
    regions = (inner for inner in state.states.values() if inner.history is None)
    return tuple([group for region in regions for group in _finals(region)])


def _camera(mission: Mission) -> CameraModel | None:
    return None if mission.camera.use == "none" else mission.camera.model()


def _shape(state: StateModel) -> Shape:
    if state.history is not None:
        return Shape.SHALLOW if state.history == "shallow" else Shape.DEEP
    if state.final:
        return Shape.FINAL
    if not state.states:
        return Shape.ATOMIC
    return Shape.PARALLEL if state.parallel else Shape.COMPOUND


def _start(model: StartModel | None) -> DefaultEntry:
    return DefaultEntry() if model is None else DefaultEntry(model.to, _outputs(model.do))


def _descriptor(event: str) -> str:
    return event if event == "*" else event.removesuffix("*").removesuffix(".")


def _outputs(actions: tuple[Act, ...]) -> tuple[Output, ...]:
    return tuple(map(_output, actions))


def _output(action: Act) -> Output:
    match action:
        case Log(text=text):
            return Output("log", str(text))
        case Raise(event=event, after=after):
            delayed = () if after is None else ("after", after)
            return Output("raise", str(event), *delayed)
        case Cancel(event=event):
            return Output("cancel", str(event))
        case Order(action=word):
            return Output("vehicle", str(word))
        case Assign(variable=variable, operation=operation, operand=operand):
            return Output("assign", str(variable), operation, operand)


def _text(model: TransitionModel, when: ex.Expression | None) -> str:
    parts = [] if model.name is None else [model.name]
    if when is not None:
        held = f" for {model.for_:g} s" if model.for_ else ""
        parts.append(f"when {ex.text(when)}{held}")
    if model.after is not None:
        parts.append(f"after {model.after:g} s")
    if model.event is not None:
        parts.append(f"on {' or '.join(model.event)}")
    return ", ".join(parts) or "always"
