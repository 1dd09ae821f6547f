"""Base classes of the models of a mission file, and the context of their validators."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Self, cast

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    PrivateAttr,
    ValidationError,
    ValidationInfo,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema
from typing_extensions import override

from missionkit.chart.model.validation_problems import plain
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.text.located_data import FILE_START, LocatedTable
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.errors import Place
from missionkit.geodesy import Origin
from missionkit.guards.geofence import InsideFence
from missionkit.messages import TRACKED, names_a_track
from missionkit.positions import UNREADABLE, ConversionContext, GeodeticPosition

NAMES_KEY = "x-name"  # in a schema, marks a text that names something of the mission
HERE = Path()
HOME = "home"  # the place of arming, a target that every mission has
NAME_PATTERN = r"^[A-Za-z][A-Za-z0-9_-]*$"
INNER_PATTERN = r"^[A-Za-z][A-Za-z0-9_-]*(/[A-Za-z][A-Za-z0-9_-]*)*$"  # a/b: b of a's included file
EVENT_PATTERN = r"^(\*|[A-Za-z][A-Za-z0-9_/-]*(\.[A-Za-z0-9_/-]+)*(\.\*|\.)?)$"


@dataclass(frozen=True, slots=True)
class Scope:
    """The names that one document defines, and the catalogue it may draw on."""

    catalogue: Catalogue
    states: frozenset[str]
    targets: frozenset[str]  # with those that are tracked
    guards: frozenset[str]
    variables: frozenset[str] = frozenset()
    folder: Path = HERE  # of the mission; files that it names are beside it or in folders below
    files: list[Path] = field(default_factory=list)  # that were read for plug-ins
    origin: Origin | None = None  # of positions in latitude and longitude
    amsl: list[GeodeticPosition] = field(default_factory=list)  # those above mean sea level
    fence: InsideFence | None = None  # of the guard `inside_fence` without parameters
    declared: Mapping[str, Any] = field(default_factory=dict)  # variables as written

    @classmethod
    def of(cls, data: Mapping[str, Any], catalogue: Catalogue, folder: Path = HERE) -> Scope:
        """Collect the names that a document in `folder` defines.

        Args:
            data: the document as read, not validated yet; what has the wrong type counts as empty.
            catalogue: reduced to what the vehicle named in `data` can fly.
            folder: to which the names of files in the document are relative.
        """
        targets, guards, variables = (
            _names(data.get(key)) for key in ("targets", "guards", "variables")
        )
        tracking = data.get("tracking")
        if tracking is not None and tracking != "none":
            targets = targets if isinstance(targets, _Unreadable) else _WithTracked(targets)
        states = _states(data.get("states"))
        vehicle = data.get("vehicle")
        kind = vehicle.get("use") if isinstance(vehicle, Mapping) else vehicle
        origin = _origin(data.get("origin"))
        names = states, targets, guards, variables
        fence = _fence(data.get("fence"), origin)
        given = data.get("variables")
        declared = given if isinstance(given, Mapping) else {}
        reduced = catalogue.flying(kind)
        return cls(reduced, *names, folder, origin=origin, fence=fence, declared=declared)


def _origin(section: object) -> Origin | None:
    """Return the origin, any if what is written is wrong: that is reported where it stands."""
    if section is None:
        return None
    given = section if isinstance(section, Mapping) else {}
    origin = Origin(*(_number(given.get(key)) for key in ("lat", "lon", "alt")))
    on_earth = abs(origin.latitude) <= 90.0 and abs(origin.longitude) <= 180.0
    return origin if on_earth and math.isfinite(origin.altitude) else UNREADABLE


def _fence(section: object, origin: Origin | None) -> InsideFence | None:
    """Return the fence, any if what is written is wrong: that is reported where it stands."""
    if section is None:
        return None
    try:
        return plain(InsideFence, section, ConversionContext(origin))
    except ValidationError:
        return InsideFence(north=(-1.0, 1.0), east=(-1.0, 1.0), height=1.0)


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else math.nan


class _Unreadable(frozenset[str]):
    """The names of a section that cannot be read: no name can be called unknown."""

    @override
    def __contains__(self, name: object) -> bool:
        return True

    @override
    def __or__(self, other: AbstractSet[Any]) -> frozenset[Any]:
        return self


class _WithTracked(frozenset[str]):
    """The names of targets in a mission that tracks others: `tracked`, and each track's own."""

    def __new__(cls, names: AbstractSet[str]) -> Self:
        """Return the names and `tracked`; those of tracks are too many to list."""
        return super().__new__(cls, {*names, TRACKED})

    @override
    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or (isinstance(name, str) and names_a_track(name))

    @override
    def __or__(self, other: AbstractSet[Any]) -> frozenset[Any]:
        return _WithTracked({*self, *other})


def _names(section: object) -> frozenset[str]:
    if section is None:
        return frozenset()
    return frozenset(section) if isinstance(section, LocatedTable) else _Unreadable()


def _states(section: object) -> frozenset[str]:
    """Return the names of all states, those inside others too."""
    names = _names(section)
    if not isinstance(section, LocatedTable):
        return names
    inner = [_states(state["states"]) for state in section.values() if _has_states(state)]
    unreadable = next((each for each in inner if isinstance(each, _Unreadable)), None)
    return names.union(*inner) if unreadable is None else unreadable


def _has_states(state: object) -> bool:
    return isinstance(state, LocatedTable) and state.get("states") is not None


def scope_of(info: ValidationInfo) -> Scope:
    """Return the scope that a document is validated in."""
    return cast(Scope, info.context)


class MissionPart(BaseModel):
    """A mapping in a mission file, which knows where it stands."""

    model_config = ConfigDict(
        frozen=True, defer_build=True, extra="forbid", strict=True, allow_inf_nan=False
    )

    _source: LocatedTable | None = PrivateAttr(default=None)

    def place(self, key: str | None = None) -> Place:
        """Return the place of this part in its file, or of the value of one of its keys."""
        if self._source is None:
            return FILE_START
        return self._source.place if key is None else self._source.place_of(key)

    @model_validator(mode="wrap")
    @classmethod
    def _locate(cls, data: object, handler: ModelWrapValidatorHandler[Self]) -> Self:
        part = handler(data)
        if isinstance(data, LocatedTable):
            part._source = data  # noqa: SLF001  its own class
        return part


class Plain:
    """Marks a field whose model belongs to another layer: validated as strictly as JSON."""

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: type[BaseModel], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Validate by `plain`, keep the model's own schema for documentation."""

        def validate(data: object, _: object, info: core_schema.ValidationInfo[Any]) -> BaseModel:
            return plain(source, data, info.context)

        return core_schema.with_info_wrap_validator_function(validate, handler(source))


@dataclass(frozen=True, slots=True, eq=False)
class Short:
    """Marks a model that may be written shorter: what it is called then, and the schemas."""

    says: str
    forms: tuple[dict[str, Any], ...]

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Allow the short forms beside the long one."""
        return {"anyOf": [*self.forms, handler(schema)]}


@dataclass(frozen=True, slots=True, eq=False)
class OneOrMore:
    """Marks a list of mappings of which one alone may be written without the list."""

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Allow the single mapping beside the list."""
        whole = handler(schema)
        return {"anyOf": [whole["items"], whole]}


@dataclass(frozen=True, slots=True)
class Known:
    """Marks a text that must name something: a state, a target, a state kind."""

    what: str
    names: Callable[[Scope], Collection[str]]

    @property
    def says(self) -> str:
        """Description of a valid value, for messages."""
        return f"the name of a {self.what}"

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Refuse a name that is not known, with the nearest."""

        def validate(name: str, info: core_schema.ValidationInfo[Any]) -> str:
            known = self.names(info.context)
            if name not in known:
                raise sentences(sentence(f"unknown {self.what} {name!r}", word=name, known=known))
            return name

        return core_schema.with_info_after_validator_function(validate, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Mark it, so that the names of one mission can be filled in."""
        return {**handler(schema), NAMES_KEY: self.what}


def _patterned(pattern: str, what: str) -> Any:
    def check(text: str) -> str:
        if not re.match(pattern, text):
            raise sentences(sentence(f"{text!r} is not a valid {what}"))
        return text

    return AfterValidator(check)


_LETTERS = "name: a letter, then letters, digits, '-' and '_'"
_NAME_FIELD = Field(json_schema_extra={"pattern": NAME_PATTERN})
Name = Annotated[str, _patterned(NAME_PATTERN, _LETTERS), _NAME_FIELD]
NodeName = Annotated[str, _patterned(INNER_PATTERN, _LETTERS), _NAME_FIELD]
GuardName = Annotated[str, _patterned(INNER_PATTERN, _LETTERS), _NAME_FIELD]
Event = Annotated[
    str,
    _patterned(EVENT_PATTERN, "event: words joined by '.', or '*'"),
    Field(json_schema_extra={"pattern": EVENT_PATTERN}),
]
StateName = Annotated[str, Known("state", lambda scope: scope.states)]
TargetName = Annotated[str, Known("target", lambda scope: scope.targets)]
KindName = Annotated[
    str,
    Known("kind of state", lambda scope: scope.catalogue.kinds),
    Field(json_schema_extra={"x-enum": "kinds"}),
]
