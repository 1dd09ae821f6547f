"""Fixtures shared by all tests."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from samples import calm

from missionkit.messages import Estimate


@pytest.fixture
def seen() -> Callable[..., Estimate]:
    """Make estimates: `seen(now=3.0, battery=None)`."""
    return calm
