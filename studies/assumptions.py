"""The numbers that a study rests on, read from the very models that fly."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from missionkit.chart.model.mission import Mission
from missionkit.sim.world import World


def assumptions(mission: Mission, world: World) -> Iterator[tuple[str, str]]:
    """Yield each part of the simulation and the mission, and its numbers in one sentence."""
    yield "wind", numbers(world.wind)
    yield "airframe", numbers(world.quadrotor)
    yield "inner autopilot", numbers(world.autopilot)
    yield from _sensors(world)
    yield "battery", numbers(world.battery)
    yield "camera", numbers(mission.camera)
    for use in mission.perception:
        yield use.plugin.kind, numbers(use.plugin)
    yield "navigation", numbers(mission.navigation.plugin)
    for name, part in mission.control.plugin:
        if isinstance(part, BaseModel):
            yield f"control: {name}", numbers(part)
    if mission.avoid is not None:
        yield "avoidance", numbers(mission.avoid.plugin)
    for name, state, _ in mission.walk():
        if state.behavior is not None and (text := numbers(state.behavior.plugin)):
            yield f"state {name}", text


def _sensors(world: World) -> Iterator[tuple[str, str]]:
    for name, sensor in world.sensors:
        if sensor is not None:
            yield name, numbers(sensor)


def numbers(model: BaseModel) -> str:
    """Return the fields of a model that have a value, each with its unit."""
    units = type(model).model_json_schema().get("properties", {})
    return ", ".join(
        _said(name, value, units[name])
        for name, value in model
        if name in units and value is not None and not isinstance(value, BaseModel)
    )


def _said(name: str, value: Any, schema: dict[str, Any]) -> str:
    words = [name.removesuffix("_deg").replace("_", " "), _shown(value)]
    if (unit := _unit(schema)) != "1":
        words.append(unit)
    if "description" in schema:
        words.append(f"({schema['description']})")
    return " ".join(words)


def _unit(schema: dict[str, Any]) -> str:
    inner = [schema, *schema.get("anyOf", ()), *schema.get("prefixItems", ())]
    return next((part["unit"] for part in inner if "unit" in part), "1")


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_shown, value))})"
    return f"{value:g}" if isinstance(value, float) else str(value)
