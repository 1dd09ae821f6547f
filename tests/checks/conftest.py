from __future__ import annotations

import pytest

from missionkit.chart.catalogue import Catalogue, builtin


@pytest.fixture(scope="session")
def catalogue() -> Catalogue:
    return builtin()
