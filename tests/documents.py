"""Reading the project's documents: their examples, commands and tables."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from pydantic.fields import FieldInfo

ROOT = Path(__file__).parents[1]
DOCS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])

MINIMAL = """\
missionkit: 1
mission: minimal
targets:
  pole: {position: [9, 0, -2]}
initial: idle
states:
  idle:
    kind: idle
    behavior: take_off
    transitions: [{to: watch, when: done}]
  watch:
    kind: hover
    transitions: [{to: home, after: 9}]
  home:
    kind: return
    behavior: {use: go_to, target: home, height: 5}
    transitions: [{to: land, when: done}]
  land:
    kind: land
"""


def document(name: str) -> str:
    """Return the text of a document, named from the root of the project."""
    return (ROOT / name).read_text(encoding="utf-8")


def blocks(language: str) -> list[Any]:
    """Return every code block in that language, as parameters of a test."""
    pattern = re.compile(rf"^```{language}\n(.*?)^```", re.MULTILINE | re.DOTALL)
    return [
        pytest.param(text, id=f"{path.relative_to(ROOT)}-{count}")
        for path in DOCS
        for count, text in enumerate(pattern.findall(path.read_text(encoding="utf-8")), 1)
    ]


def plugin_files(folder: Path) -> list[Path]:
    """Write the plug-ins that the documents define into a folder; return the files."""
    pattern = re.compile(r"^```python\n# (missionkit_\w+\.py)\n(.*?)^```", re.MULTILINE | re.DOTALL)
    found = [block for path in DOCS for block in pattern.findall(path.read_text(encoding="utf-8"))]
    for name, text in found:
        (folder / name).write_text(text, encoding="utf-8")
    return [folder / name for name, _ in found]


def as_mission(text: str) -> str:
    """Return an example as a mission: as it is, or put into a minimal one."""
    example = yaml.safe_load(text)
    if "missionkit" in example:
        return text
    if "when" in example:
        example = {"failsafes": [{"name": "shown", "to": "land", **example}]}
    mission = yaml.safe_load(MINIMAL)
    for section, value in example.items():
        before = mission.get(section)
        mission[section] = {**before, **value} if isinstance(before, dict) else value
    return yaml.safe_dump(mission, sort_keys=False)


def table(text: str, heading: str) -> list[list[str]]:
    """Return the rows of the first table below a heading."""
    section = re.split(rf"^#+ {heading}$", text, flags=re.MULTILINE)[1]
    from_table = itertools.dropwhile(lambda line: not line.startswith("|"), section.splitlines())
    lines = itertools.takewhile(lambda line: line.startswith("|"), from_table)
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines][2:]


def defaults(fields: dict[str, FieldInfo]) -> Iterator[tuple[str, str]]:
    """Yield each key as a file writes it and its default as a table writes it."""
    for name, field in fields.items():
        default = "required" if field.is_required() else _shown(field.get_default())
        yield field.alias or name, default


def _shown(value: object) -> str:
    match value:
        case None:
            return "—"
        case bool() | str():
            return str(value) if value and value is not True else json.dumps(value)
        case int() | float():
            return f"{value:.10g}"
        case tuple():
            return f"[{', '.join(map(_shown, value))}]"
        case dict():
            return f"{{{', '.join(f'{key}: {it}' for key, it in value.items())}}}"
        case _:
            return "{}"
