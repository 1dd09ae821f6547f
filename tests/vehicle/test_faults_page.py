"""The table of faults names tests that are there, and every fault there is."""

from __future__ import annotations

import ast

import pytest
from documents import ROOT, document, table

from missionkit.sitl.wire_faults import BODY_FAULTS, WIRE

ROWS = table(document("docs/reference/faults.md"), "The table")


def functions(path: str) -> set[str]:
    """Return the names of the tests in a file."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


def test_the_table_is_long_and_complete() -> None:
    assert len(ROWS) >= 25
    assert [row for row in ROWS if len(row) != 4 or not all(row)] == []
    documented = " ".join(row[0] for row in ROWS)
    assert [name for name in (*WIRE, *BODY_FAULTS) if f"`{name}" not in documented] == []


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_the_test_of_a_line_exists(row: list[str]) -> None:
    path, name = row[3].strip("`").split("::")
    assert name.startswith("test_")
    assert name in functions(f"tests/{path}")
