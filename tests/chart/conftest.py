from __future__ import annotations

from pathlib import Path

import pytest

from missionkit.chart.plugin_catalogue import Catalogue, builtin

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def catalogue() -> Catalogue:
    return builtin()


@pytest.fixture(scope="session")
def example() -> Path:
    return ROOT / "missions" / "precision_task.yaml"
