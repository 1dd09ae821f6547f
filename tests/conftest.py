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
    """Put first what takes longest: flights over the wire, which mostly wait, then other flights.

    Distributed by files, the last ones are then short, and no worker is left alone at the end.
    """
    here = Path(__file__).parent

    def turn(item: pytest.Item) -> tuple[bool, bool, bool]:
        over_the_wire = item.path.parent == here / "vehicle"
        return (item.path.name not in LONGEST, not over_the_wire, item.path.parent != here)

    items.sort(key=turn)


@pytest.fixture
def update_refs(request: pytest.FixtureRequest) -> bool:
    """Whether golden files are to be rewritten."""
    return bool(request.config.getoption("--update-refs"))


@pytest.fixture
def seen() -> Callable[..., Estimate]:
    """Make estimates: `seen(now=3.0, battery=None)`."""
    return calm
