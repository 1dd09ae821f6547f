from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field

from missionkit.chart.load import load, parse
from missionkit.chart.model_file import MAX_PROBLEMS, load_model
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import FileError
from missionkit.units import Metres, Point


class Box(BaseModel):
    model_config = ConfigDict(extra="forbid")
    use: Literal["box"]
    size: Metres = Field(gt=0)


class Ball(BaseModel):
    model_config = ConfigDict(extra="forbid")
    use: Literal["ball"]
    radius: Metres


class Room(BaseModel):
    model_config = ConfigDict(extra="forbid")
    at: Point
    obstacles: tuple[Annotated[Box | Ball, Field(discriminator="use")], ...] = ()


def messages_of(path: Path) -> list[str]:
    with pytest.raises(FileError) as error:
        load_model(path, Room)
    return [str(problem).partition("room.yaml:")[2] for problem in error.value.problems]


def test_a_missing_world_is_reported_before_the_flight(
    tmp_path: Path, example: Path, catalogue: Catalogue
):
    (tmp_path / "worlds").mkdir()
    (tmp_path / "worlds" / "orchrd.yaml").touch()
    mission = tmp_path / "m.yaml"
    mission.write_text(example.read_text())
    with pytest.raises(FileError) as error:
        load(mission, catalogue)
    (problem,) = error.value.problems
    assert (problem.place.line, problem.place.column) == (6, 8)
    assert problem.message == (
        "world 'worlds/orchard.yaml': no such file beside the mission; "
        "did you mean 'worlds/orchrd.yaml'? Known: worlds/orchrd.yaml"
    )


def test_plain_values_are_read_too(tmp_path: Path):
    path = tmp_path / "room.yaml"
    path.write_text("at: [1, 2, 3]\nobstacles: [{use: ball, radius: 2}]\n")
    assert load_model(path, Room) == Room(at=(1, 2, 3), obstacles=(Ball(use="ball", radius=2),))


def test_plain_values_have_the_same_messages(tmp_path: Path):
    path = tmp_path / "room.yaml"
    path.write_text(
        "at: [1, two, 3]\n"
        "obstacles:\n"
        "  - {use: boxx, size: 2}\n"
        "  - {use: box, size: -1, colour: red}\n"
        "  - {size: 1}\n"
        "  - {use: ball, radius: .nan}\n"
    )
    assert messages_of(path) == [
        "1:9: 'at', item 2: expected a list of 3 numbers (m), got 'two'",
        "3:5: 'obstacles', item 1: 'boxx' is unknown; did you mean 'box'? Known: ball, box",
        "4:22: obstacle 2: 'size': must be above 0 m, got -1",
        "4:26: obstacle 2: unknown key 'colour'; known: size, use",
        "5:5: 'obstacles', item 3: missing key 'use'",
        "6:25: .nan is not a finite number",
    ]


@pytest.mark.parametrize("text", ["[1]", "word", "12"])
def test_a_file_is_a_mapping(tmp_path: Path, text: str):
    path = tmp_path / "room.yaml"
    path.write_text(text)
    (only,) = messages_of(path)
    assert only.startswith("1:1: expected a mapping (key: value), got ")


def test_problems_come_in_the_order_of_the_file_and_do_not_flood(catalogue: Catalogue):
    text = "missionkit: 1\nmission: m\ninitial: s0\nstates:\n"
    text += "".join(f"  s{n}: {{kind: wrong}}\n" for n in range(200))
    with pytest.raises(FileError) as error:
        parse(text, "m.yaml", catalogue)
    lines = [problem.place.line for problem in error.value.problems]
    assert len(lines) == MAX_PROBLEMS + 1
    assert lines == sorted(lines)
    assert error.value.problems[-1].message == "and 150 more problems from here on"


def test_a_section_that_cannot_be_read_is_one_problem(catalogue: Catalogue):
    text = (
        "missionkit: 1\nmission: m\ninitial: idle\ntargets: [trunk]\nguards: 3\n"
        "states:\n  idle:\n    kind: idle\n    behavior: {use: servo, target: trunk}\n"
        "    transitions: [{to: idle, when: sure}]\n"
    )
    with pytest.raises(FileError) as error:
        parse(text, "m.yaml", catalogue)
    assert [str(problem) for problem in error.value.problems] == [
        "m.yaml:4:10: 'targets': expected a mapping, got a list",
        "m.yaml:5:9: 'guards': expected a mapping, got 3",
    ]


def test_parameters_of_the_command_line_reach_the_mission(example: Path, catalogue: Catalogue):
    mission = load(example, catalogue, {"cruise": "3"})
    assert getattr(mission.states["gps"].behavior.plugin, "speed", None) == 3.0
    with pytest.raises(FileError, match=r"got 'fast' \(from \$cruise\)"):
        load(example, catalogue, {"cruise": "fast"})
