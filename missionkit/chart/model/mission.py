"""The mission as a model: exactly what a mission file may say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    PrivateAttr,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)

from missionkit.chart.model.actions import Action
from missionkit.chart.model.guard_expressions import Use
from missionkit.chart.model.guard_parser import Condition
from missionkit.chart.model.mission_sections import (
    Settings,
    Success,
    TargetPlace,
    Vehicle,
    one_or_more,
)
from missionkit.chart.model.model_base import (
    NAMED,
    Event,
    GuardName,
    KindName,
    MissionPart,
    Name,
    NodeName,
    OneOrMore,
    Plain,
    Short,
    StateName,
    scope_of,
)
from missionkit.chart.model.plugin_references import Reference
from missionkit.chart.model.variables import Variable
from missionkit.chart.text.located_data import (
    Row,
    Table,
    Text,
    place_of,
)
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.control.controller import Control
from missionkit.messages import Occupancy
from missionkit.perception.camera_section import Camera
from missionkit.planning.avoidance_planner import AvoidancePlanner
from missionkit.planning.map_section import KnownMap
from missionkit.plugin import Plugin
from missionkit.plugin_protocols import BehaviorProtocol
from missionkit.units import Seconds

Actions = Annotated[tuple[Action, ...], Field(strict=False)]
GROUP_KIND = "logic"
SHAPES = ("states", "parallel", "final", "history")


def _listed(data: object) -> object:
    if not isinstance(data, str):
        return data
    row = Row(place_of(data))
    row.put(data, place_of(data))
    return row


_SCALAR = ({"type": ["number", "string", "boolean"]},)
_ONE_OR_MORE: dict[str, list[dict[str, Any]]] = {
    "anyOf": [
        {"type": "string"},
        {"type": "array", "items": {"type": "string"}, "minItems": 1},
    ]
}
_STATE = {"type": "string", NAMED: "state"}
_STATES: dict[str, list[dict[str, Any]]] = {
    "anyOf": [_STATE, {"type": "array", "items": _STATE, "minItems": 1}]
}
StateNames = Annotated[
    tuple[StateName, ...],
    Field(strict=False, min_length=1),
    BeforeValidator(_listed),
    WithJsonSchema(_STATES),
]
Events = Annotated[
    tuple[Event, ...],
    Field(strict=False, min_length=1),
    BeforeValidator(_listed),
    WithJsonSchema(_ONE_OR_MORE),
]
_NO_TIME = "'for' needs 'when': it says how long the guard must hold"


class Transition(MissionPart):
    """A way out of a state: taken when all that it names is fulfilled."""

    model_config = ConfigDict(
        json_schema_extra={"anyOf": [{"required": ["to"]}, {"required": ["do"]}]}
    )

    to: StateNames | None = Field(
        default=None, description="state to go to, one for each region; absent: only `do`"
    )
    when: Condition | None = Field(default=None, description="guard that must hold")
    for_: Seconds = Field(default=0.0, alias="for", description="how long it must hold")
    after: Seconds | None = Field(default=None, description="time since entry to the state")
    event: Events | None = Field(
        default=None, description="event that must have come; `a` also means `a.b`, `*` any"
    )
    do: Actions = ()
    name: Name | None = None
    internal: bool = Field(default=False, description="does not leave a state around its target")
    emergency: bool = Field(default=False, description="does not wait for the dwell time")

    @model_validator(mode="after")
    def _has_reason(self) -> Self:
        if "for_" in self.model_fields_set and self.when is None:
            raise sentences(sentence(_NO_TIME, "for", at_key=True))
        if self.when is None and self.after is None and self.event is None:
            raise sentences(sentence("needs at least one of 'when', 'after', 'event'"))
        if self.to is None and not self.do:
            raise sentences(sentence("needs 'to', 'do' or both: it would do nothing", "to"))
        return self

    @property
    def targets(self) -> tuple[str, ...]:
        """The states it names, none if it goes nowhere."""
        return self.to or ()


class Failsafe(MissionPart):
    """A transition out of every flying state, tried before the states' own."""

    name: Name
    when: Condition
    for_: Seconds = Field(default=0.0, alias="for", description="how long the guard must hold")
    unknown: Literal["take", "ignore"] = Field(
        default="take", description="what to do when the guard cannot tell"
    )
    to: StateName
    do: Actions = ()


class Invariant(MissionPart):
    """Condition that must hold in the state, in addition to its kind's."""

    holds: Condition | None = None
    exit: StateName | None = Field(default=None, description="where to go when it is violated")


class Start(MissionPart):
    """Where a state begins: the name of a state inside it, or one for each region."""

    to: StateNames
    do: Actions = ()

    @model_validator(mode="before")
    @classmethod
    def _written_short(cls, data: object) -> object:
        if isinstance(data, str | Row):
            return Table(place_of(data)).extended("to", data, place_of(data))
        return data


Begins = Annotated[Start, Short("the name of a state", tuple(_STATES["anyOf"]))]


class State(MissionPart):
    """One state: its kind's contract, what it does, the states inside it, the ways out of it."""

    kind: KindName
    summary: str = ""
    behavior: Annotated[Use[BehaviorProtocol], Reference("behaviors")] | None = None
    transitions: Annotated[tuple[Transition, ...], Field(strict=False)] = ()
    entry: Actions = ()
    exit: Actions = ()
    dwell: Seconds | None = Field(default=None, description="instead of the mission's")
    invariant: Invariant = Invariant()
    states: dict[NodeName, State] = Field(default={}, description="the states inside")
    initial: Begins | None = Field(default=None, description="the first one of them")
    parallel: bool = Field(default=False, description="the states inside are active together")
    final: bool = Field(default=False, description="the state around is done here")
    history: Literal["shallow", "deep"] | None = Field(
        default=None, description="leads to where the state around was left"
    )
    default: Begins | None = Field(default=None, description="history: where if never entered")
    stays: bool = Field(default=False, description="may last for ever on purpose")

    @model_validator(mode="before")
    @classmethod
    def _defaults(cls, data: object, info: ValidationInfo) -> object:
        if not isinstance(data, Table):
            return data
        if "kind" not in data and any(shape in data for shape in SHAPES):
            data = data.extended("kind", Text(GROUP_KIND, data.place), data.place)
        if "behavior" in data or "states" in data:
            return data
        kind = scope_of(info).catalogue.kinds.get(str(data.get("kind")))
        if kind is None or kind.default_behavior is None:
            return data
        place = data.place_of("kind")
        return data.extended("behavior", Text(kind.default_behavior, place), place)

    @model_validator(mode="after")
    def _commanded(self) -> Self:
        if self.behavior is None and self.kind != GROUP_KIND and not self.states:
            raise sentences(sentence("missing key 'behavior': a behaviour, {use: ...}"))
        return self


Conditions = Annotated[
    tuple[Success, ...],
    Field(strict=False, description="all of them must be met"),
    BeforeValidator(one_or_more),
    OneOrMore(),
]


class Placed(NamedTuple):
    """One state of the tree, and the one around it."""

    name: str
    state: State
    parent: str | None


def walk(states: Mapping[str, State], parent: str | None = None) -> Iterator[Placed]:
    """Yield every state of a tree in document order."""
    for name, state in states.items():
        yield Placed(name, state, parent)
        yield from walk(state.states, name)


def around(states: Mapping[str, Placed], parent: str | None) -> tuple[str, ...]:
    """Return a state's parent and the states around that, the innermost first."""
    found: list[str] = []
    while parent is not None:
        found.append(parent)
        parent = states[parent].parent
    return tuple(found)


def firsts(states: Mapping[str, Placed]) -> dict[str, str]:
    """Return the first state of each kind."""
    found: dict[str, str] = {}
    for name, state, _ in states.values():
        found.setdefault(state.kind, name)
    return found


def _use(kind: str) -> Any:
    return {"use": kind}


class Mission(MissionPart):
    """A mission file, version 1."""

    version: Literal[1] = Field(alias="missionkit", description="version of the file format")
    name: Name = Field(alias="mission")
    summary: str = ""
    params: dict[str, Any] = Field(default={}, description="values that $name stands for")
    world: str | None = Field(default=None, description="for the simulator, beside this file")
    vehicle: Vehicle = Vehicle()
    navigation: Annotated[Use[Plugin], Reference("navigators")] = Field(
        default=_use("visual_inertial_ekf"), validate_default=True
    )
    camera: Annotated[Camera, Plain] = Camera()
    map: Annotated[KnownMap, Plain] | None = None
    targets: dict[Name, TargetPlace] = Field(default={})
    perception: Annotated[
        tuple[Annotated[Use[Plugin], Reference("detectors")], ...], Field(strict=False)
    ] = ()
    avoid: Annotated[Use[AvoidancePlanner] | None, Reference("planners", optional=True)] = Field(
        default=_use("potential_field"), validate_default=True
    )
    control: Annotated[Control, Plain] = Control()
    variables: dict[GuardName, Annotated[Variable, Short("a value", _SCALAR)]] = Field(
        default={}, description="what the chart remembers"
    )
    guards: dict[GuardName, Condition] = Field(default={}, description="named once, used by name")
    failsafes: Annotated[tuple[Failsafe, ...], Field(strict=False)] = ()
    initial: Begins
    states: Annotated[dict[NodeName, State], Field(min_length=1)]
    success: Conditions = ()
    dwell: Seconds = Field(default=2.0, description="least time between two transitions")
    settings: Settings = Settings()

    _included: tuple[Path, ...] = PrivateAttr(default=())
    _known: Occupancy | None = PrivateAttr(default=None)

    @property
    def included(self) -> tuple[Path, ...]:
        """The files that were included, in the order they were read, then those of the map."""
        return self._included

    @property
    def known(self) -> Occupancy | None:
        """The map that was read, if there is one."""
        return self._known

    def with_files(self, files: tuple[Path, ...], known: Occupancy | None) -> Self:
        """Return the mission with the files that were read beside its own, and the map in them."""
        copied = self.model_copy()
        copied._included, copied._known = files, known  # noqa: SLF001 - the copy is of this class
        return copied

    def walk(self) -> Iterator[Placed]:
        """Yield every state in document order."""
        return walk(self.states)

    def by_name(self) -> dict[str, Placed]:
        """Return every state by its name, in document order."""
        return {placed.name: placed for placed in self.walk()}
