"""Fixtures shared by all tests."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from samples import calm

from missionkit.messages import Estimate


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let golden files be rewritten."""
    parser.addoption("--update-refs", action="store_true", help="write golden files")


@pytest.fixture
def update_refs(request: pytest.FixtureRequest) -> bool:
    """Whether golden files are to be rewritten."""
    return bool(request.config.getoption("--update-refs"))


@pytest.fixture
def seen() -> Callable[..., Estimate]:
    """Make estimates: `seen(now=3.0, battery=None)`."""
    return calm
