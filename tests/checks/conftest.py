from __future__ import annotations

import pytest

from missionkit.chart.plugin_catalogue import Catalogue, builtin


@pytest.fixture(scope="session")
def catalogue() -> Catalogue:
    return builtin()
