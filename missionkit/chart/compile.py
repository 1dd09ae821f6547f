"""From the model of a mission to the chart that the tick steps."""

from __future__ import annotations

from missionkit.chart import expressions as ex
from missionkit.chart.actions import Action, Log
from missionkit.chart.ask import Asker
from missionkit.chart.catalogue import Catalogue
from missionkit.chart.compiled import Chart, Output, State, Transition
from missionkit.chart.contracts import fulfilled
from missionkit.chart.model import Failsafe, Mission
from missionkit.chart.model import State as StateModel
from missionkit.chart.model import Transition as TransitionModel
from missionkit.errors import Place

NOWHERE = Place("", 0, 0)
STUCK = 3.0  # s a plug-in may misbehave before the vehicle goes home
STUCK_FOR_GOOD = 6.0  # s before it lands


def compile_mission(mission: Mission, catalogue: Catalogue) -> Chart:
    """Compile a mission that was loaded without problems.

    The contracts of the state kinds are carried out first: default failsafes and, where one of
    them needs it, a hover state.
    """
    mission = fulfilled(mission, catalogue)
    return _Compiler(mission, catalogue).chart()


class _Compiler:
    def __init__(self, mission: Mission, catalogue: Catalogue) -> None:
        self.mission = mission
        self.catalogue = catalogue
        self.asker = Asker(dict(mission.guards))
        self.count = 0

    def chart(self) -> Chart:
        states = {name: self._state(name, state) for name, state in self.mission.states.items()}
        land = _of_kind(self.mission, "land")
        failsafes = tuple(map(self._failsafe, self.mission.failsafes)) + self._stuck(land)
        return Chart(self.mission.initial, states, failsafes, tuple(self.asker.slots), land)

    def _state(self, name: str, state: StateModel) -> State:
        kind = self.catalogue.kinds[state.kind]
        behavior = state.behavior.plugin
        targets = behavior.targets()
        escape = kind.invariant.to_kind if kind.invariant is not None else None
        return State(
            name=name,
            kind=kind,
            behavior=behavior,
            target=targets[0] if targets else None,
            dwell=self.mission.dwell if state.dwell is None else state.dwell,
            transitions=tuple(map(self._transition, state.transitions)),
            entry=_outputs(state.entry),
            exit=_outputs(state.exit),
            violated_to=state.invariant.exit or _kind_or_none(self.mission, escape),
            tolerated=kind.invariant.tolerated if kind.invariant is not None else 0.0,
            promise=None
            if state.invariant.holds is None
            else self.asker.ask(state.invariant.holds),
        )

    def _transition(self, model: TransitionModel) -> Transition:
        return Transition(
            number=self._next(),
            to=model.to,
            text=_text(model),
            ask=None if model.when is None else self.asker.ask(model.when),
            hold=model.for_,
            after=model.after,
            event=model.event,
            outputs=_outputs(model.do),
            patient=not model.emergency,
            reads=frozenset() if model.when is None else self._names(model.when),
        )

    def _failsafe(self, model: Failsafe) -> Transition:
        return Transition(
            number=self._next(),
            to=model.to,
            text=f"failsafe {model.name}",
            ask=self.asker.ask(model.when),
            hold=model.for_,
            outputs=_outputs(model.do),
            unknown_takes=model.unknown == "take",
            reads=self._names(model.when),
        )

    def _stuck(self, land: str) -> tuple[Transition, ...]:
        """Return what happens when plug-ins keep failing, after the mission's own failsafes."""
        guard: ex.Expression = ex.Use(
            "plugin_failed", self.catalogue.guards["plugin_failed"](), NOWHERE
        )
        home = _kind_or_none(self.mission, "return") or land
        return tuple(
            Transition(
                number=self._next(),
                to=to,
                text="failsafe plug-in failed",
                ask=self.asker.ask(guard),
                hold=hold,
                reads=self._names(guard),
            )
            for to, hold in ((home, STUCK), (land, STUCK_FOR_GOOD))
        )

    def _next(self) -> int:
        self.count += 1
        return self.count

    def _names(self, expression: ex.Expression) -> frozenset[str]:
        """Return what the record calls the guards that an expression asks."""
        match expression:
            case ex.All(parts=parts) | ex.Any(parts=parts):
                return frozenset().union(*map(self._names, parts))
            case ex.Not(part=part):
                return self._names(part)
            case ex.Named() | ex.Use() | ex.Hysteresis():
                return frozenset((self.asker.name(expression),))


def _of_kind(mission: Mission, kind: str) -> str:
    return next(name for name, state in mission.states.items() if state.kind == kind)


def _kind_or_none(mission: Mission, kind: str | None) -> str | None:
    return next((name for name, state in mission.states.items() if state.kind == kind), None)


def _outputs(actions: tuple[Action, ...]) -> tuple[Output, ...]:
    return tuple(
        Output("log", str(action.text))
        if isinstance(action, Log)
        else Output("raise", str(action.event))
        for action in actions
    )


def _text(model: TransitionModel) -> str:
    parts = [] if model.name is None else [model.name]
    if model.when is not None:
        held = f" for {model.for_:g} s" if model.for_ else ""
        parts.append(f"when {ex.text(model.when)}{held}")
    if model.after is not None:
        parts.append(f"after {model.after:g} s")
    if model.event is not None:
        parts.append(f"on {model.event}")
    return ", ".join(parts)
