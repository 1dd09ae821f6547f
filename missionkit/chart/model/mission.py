"""The mission as a model: exactly what a mission file may say."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    ValidationInfo,
    model_validator,
)

from missionkit.chart.model.guard_expressions import Use
from missionkit.chart.model.guard_parser import Condition
from missionkit.chart.model.mission_sections import (
    OriginSection,
    Settings,
    Success,
    TargetPlace,
    VehicleSection,
    one_or_more,
)
from missionkit.chart.model.model_base import (
    GuardName,
    MissionPart,
    Name,
    NodeName,
    OneOrMore,
    Plain,
    Short,
    scope_of,
)
from missionkit.chart.model.placed_states import Placed, walk
from missionkit.chart.model.plugin_references import PluginReference
from missionkit.chart.model.requirements import Requirement
from missionkit.chart.model.state_definitions import Begins, Failsafe, State
from missionkit.chart.model.variables import Variable
from missionkit.chart.text.located_data import LocatedTable, Text
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.control.controller import Control
from missionkit.control.controller_protocol import ControllerProtocol
from missionkit.geodesy import Origin
from missionkit.guards.geofence import InsideFence
from missionkit.messages import Occupancy
from missionkit.perception.camera_section import Camera
from missionkit.planning.avoidance_planner import AvoidancePlanner
from missionkit.planning.map_section import KnownMap
from missionkit.plugin import Plugin
from missionkit.plugin_protocols import TrackerProtocol
from missionkit.units import Seconds

_SCALAR = ({"type": ["number", "string", "boolean"]},)
Conditions = Annotated[
    tuple[Success, ...],
    Field(strict=False, description="all of them must be met"),
    BeforeValidator(one_or_more),
    OneOrMore(),
]


def _use(kind: str) -> Any:
    return {"use": kind}


class Mission(MissionPart):
    """A mission file, version 1."""

    version: Literal[1] = Field(alias="missionkit", description="version of the file format")
    name: Name = Field(alias="mission")
    summary: str = ""
    params: dict[str, Any] = Field(default={}, description="values that $name stands for")
    world: str | None = Field(default=None, description="for the simulator, beside this file")
    origin: OriginSection | None = None
    vehicle: VehicleSection = VehicleSection()
    navigation: Annotated[Use[Plugin], PluginReference("navigators")] = Field(
        default=_use("visual_inertial_ekf"), validate_default=True
    )
    camera: Annotated[Camera, Plain] = Camera()
    map: Annotated[KnownMap, Plain] | None = None
    fence: Annotated[InsideFence, Plain] | None = None
    targets: dict[Name, TargetPlace] = Field(default={})
    perception: Annotated[
        tuple[Annotated[Use[Plugin], PluginReference("detectors")], ...], Field(strict=False)
    ] = ()
    tracking: Annotated[Use[TrackerProtocol] | None, PluginReference("trackers", optional=True)] = (
        None
    )
    avoid: Annotated[Use[AvoidancePlanner] | None, PluginReference("planners", optional=True)] = (
        Field(default=_use("potential_field"), validate_default=True)
    )
    control: Annotated[Use[ControllerProtocol], PluginReference("controllers")] = Field(
        default=_use("velocity_pid"), validate_default=True
    )
    variables: dict[GuardName, Annotated[Variable, Short("a value", _SCALAR)]] = Field(
        default={}, description="what the chart remembers"
    )
    guards: dict[GuardName, Condition] = Field(default={}, description="named once, used by name")
    failsafes: Annotated[tuple[Failsafe, ...], Field(strict=False)] = ()
    initial: Begins
    states: Annotated[dict[NodeName, State], Field(min_length=1)]
    success: Conditions = ()
    requirements: Annotated[tuple[Requirement, ...], Field(strict=False)] = Field(
        default=(), description="watched in flight, counted in campaigns, checked on records"
    )
    dwell: Seconds = Field(default=2.0, description="least time between two transitions")
    settings: Settings = Settings()

    _included: tuple[Path, ...] = PrivateAttr(default=())
    _known: Occupancy | None = PrivateAttr(default=None)
    _has_amsl: bool = PrivateAttr(default=False)

    @model_validator(mode="before")
    @classmethod
    def _sections(cls, data: object, info: ValidationInfo) -> object:
        """Name the plug-ins that the kind of vehicle flies with where the file does not."""
        if not isinstance(data, LocatedTable):
            return data
        vehicle = scope_of(info).catalogue.vehicle
        for section, kind in vehicle.sections.items():
            if section not in data and cls.model_fields[section].default != _use(kind):
                data = data.extended(section, Text(kind, data.place), data.place)
        control = data.get("control")
        if isinstance(control, LocatedTable) and "use" not in control:
            word = Text(vehicle.sections["control"], control.place)
            data = data.extended(
                "control", control.extended("use", word, control.place), data.place_of("control")
            )
        return data

    @model_validator(mode="after")
    def _flown(self, info: ValidationInfo) -> Self:
        self._has_amsl = bool(scope_of(info).amsl)
        vehicle = scope_of(info).catalogue.vehicle
        navigator = self.navigation
        fits = getattr(navigator.plugin, "vehicles", (vehicle.name,))  # of another package: any
        if vehicle.name not in fits:
            raise sentences(
                sentence(
                    f"{navigator.kind!r} is for vehicle {fits[0]!r}, but the mission's is "
                    f"{vehicle.name!r}: use {vehicle.sections['navigation']}",
                    "navigation",
                )
            )
        gives = getattr(self.control.plugin, "setpoint", "wrench")
        if gives != vehicle.setpoint:
            raise sentences(
                sentence(
                    f"controller {self.control.kind!r} gives a {gives}, but vehicle "
                    f"{vehicle.name!r} flies a {vehicle.setpoint}",
                    "control",
                )
            )
        return self

    @property
    def velocity_control(self) -> Control | None:
        """The controller of a vehicle that flies velocities, None for another vehicle."""
        controller = self.control.plugin
        return controller if isinstance(controller, Control) else None

    @property
    def included(self) -> tuple[Path, ...]:
        """The files that were included, in the order they were read, then those of the map."""
        return self._included

    @property
    def geodetic_origin(self) -> Origin | None:
        """Where [0, 0, 0] is on the earth, if the mission says so."""
        return None if self.origin is None else self.origin.geodetic

    @property
    def has_amsl(self) -> bool:
        """Whether it has positions whose height is above mean sea level."""
        return self._has_amsl

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
