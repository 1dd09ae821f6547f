"""However a mission file is broken, it is read, or refused with places: nothing else happens."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from missionkit.chart.load import parse
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import FileError

TEXT = (Path(__file__).parents[2] / "missions" / "precision_task.yaml").read_text()
LINES = TEXT.splitlines()
CATALOGUE = builtin()
INDICATORS = st.sampled_from([*"{}[]:,-&*!|>'\"%@`#\t\n $?~\0é", ": ", "- ", "<<"])
VALUES = st.sampled_from(
    ["null", "true", "-1", "1e400", ".nan", "[]", "{}", "''", "[[1]]", "{use: x}", "$cruise", "*a"]
)


def read_or_refused(text: str) -> None:
    try:
        mission = parse(text, "m.yaml", CATALOGUE)
    except FileError as error:
        problems = error.problems
    else:
        assert isinstance(mission, Mission)
        return
    assert problems
    assert all(problem.place.line >= 1 and problem.message for problem in problems)
    assert all(problem.place.file == "m.yaml" for problem in problems)


@settings(deadline=None, max_examples=150, derandomize=True, database=None)
@given(
    st.lists(
        st.tuples(st.integers(0, len(TEXT)), st.integers(0, 12), INDICATORS | VALUES), max_size=4
    )
)
def test_spliced_text(edits: list[tuple[int, int, str]]):
    text = TEXT
    for at, length, new in edits:
        text = text[:at] + new + text[at + length :]
    read_or_refused(text)


@settings(deadline=None, max_examples=100, derandomize=True, database=None)
@given(st.integers(0, len(LINES) - 1), st.integers(0, len(LINES) - 1), VALUES)
def test_moved_lines_and_replaced_values(first: int, second: int, value: str):
    lines = list(LINES)
    lines[first], lines[second] = lines[second], lines[first]
    key, colon, _ = lines[first].partition(": ")
    lines[first] = f"{key}{colon}{value}"
    read_or_refused("\n".join(lines))


@settings(deadline=None, max_examples=100, derandomize=True, database=None)
@given(st.text(max_size=60))
def test_any_text(text: str):
    read_or_refused(text)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=5) | VALUES,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["use", "all", "to", "when", "kind"]), inner, max_size=3)
    ),
    max_leaves=8,
)
SECTIONS = st.sampled_from(sorted(Mission.model_json_schema()["properties"]))


@settings(deadline=None, max_examples=150, derandomize=True, database=None)
@given(st.dictionaries(SECTIONS, JSON, max_size=6))
def test_any_values_in_any_section(sections: dict[str, object]):
    read_or_refused("".join(f"{key}: {value!r}\n" for key, value in sections.items()))
