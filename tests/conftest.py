"""Fixtures shared by all tests."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from samples import calm

from missionkit.messages import Estimate

LONGEST = ("test_how_to_sitl.py", "test_wire_interrupt.py", "test_wire_silence.py")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let golden files be rewritten."""
    parser.addoption("--update-refs", action="store_true", help="write golden files")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put first what takes longest; flights over the wire and other tests by turns, file by file.

    Distributed by files, the last ones are then short, so that no worker is left alone at the end;
    and while one worker waits for a flight over the wire, another has something to compute.
    """
    here = Path(__file__).parent
    files = {item.path: item.path.name for item in items}
    order = sorted(files, key=lambda it: (files[it] not in LONGEST, it.parent != here, it))
    wire = [path for path in order if files[path].startswith("test_wire_")]
    rest = [path for path in order if path not in wire]
    turns = {path: turn for group in (wire, rest) for turn, path in enumerate(group)}
    items.sort(key=lambda item: turns[item.path])


@pytest.fixture
def update_refs(request: pytest.FixtureRequest) -> bool:
    """Whether golden files are to be rewritten."""
    return bool(request.config.getoption("--update-refs"))


@pytest.fixture
def seen() -> Callable[..., Estimate]:
    """Make estimates: `seen(now=3.0, battery=None)`."""
    return calm
