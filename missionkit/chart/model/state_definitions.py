"""The states of a mission file, the ways out of them, and its failsafes."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)

from missionkit.chart.model.actions import Action
from missionkit.chart.model.guard_expressions import Use
from missionkit.chart.model.guard_parser import Condition
from missionkit.chart.model.model_base import (
    NAMES_KEY,
    Event,
    KindName,
    MissionPart,
    Name,
    NodeName,
    Short,
    StateName,
    scope_of,
)
from missionkit.chart.model.plugin_references import PluginReference
from missionkit.chart.text.located_data import (
    LocatedList,
    LocatedTable,
    Text,
    place_of,
)
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.plugin_protocols import BehaviorProtocol
from missionkit.units import Seconds

Actions = Annotated[tuple[Action, ...], Field(strict=False)]
GROUP_KIND = "logic"
SHAPE_KEYS = ("states", "parallel", "final", "history")


def _listed(data: object) -> object:
    if not isinstance(data, str):
        return data
    row = LocatedList(place_of(data))
    row.put(data, place_of(data))
    return row


_ONE_OR_MORE: dict[str, list[dict[str, Any]]] = {
    "anyOf": [
        {"type": "string"},
        {"type": "array", "items": {"type": "string"}, "minItems": 1},
    ]
}
_STATE_NAME = {"type": "string", NAMES_KEY: "state"}
_STATE_NAMES: dict[str, list[dict[str, Any]]] = {
    "anyOf": [_STATE_NAME, {"type": "array", "items": _STATE_NAME, "minItems": 1}]
}
StateNames = Annotated[
    tuple[StateName, ...],
    Field(strict=False, min_length=1),
    BeforeValidator(_listed),
    WithJsonSchema(_STATE_NAMES),
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
        if isinstance(data, str | LocatedList):
            return LocatedTable(place_of(data)).extended("to", data, place_of(data))
        return data


Begins = Annotated[Start, Short("the name of a state", tuple(_STATE_NAMES["anyOf"]))]


class State(MissionPart):
    """One state: its kind's contract, what it does, the states inside it, the ways out of it."""

    kind: KindName
    summary: str = ""
    behavior: Annotated[Use[BehaviorProtocol], PluginReference("behaviors")] | None = None
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
        if not isinstance(data, LocatedTable):
            return data
        if "kind" not in data and any(shape in data for shape in SHAPE_KEYS):
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
