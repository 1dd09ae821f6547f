from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from suite import Case, UnreachableError, cases

from missionkit.interchange.charts.scxml_chart import beyond_plain, convert


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Give each chart of the suite to the tests that ask for charts of its sort."""
    for sort in {"plain", "more"} & set(metafunc.fixturenames):
        try:
            chosen = [case for case in _cases(metafunc.config) if sort == _sort(case)]
        except UnreachableError as error:
            away = pytest.param(None, marks=pytest.mark.skip(str(error)), id="unreachable")
            metafunc.parametrize(sort, [away])
        else:
            metafunc.parametrize(sort, [pytest.param(case, id=case.name) for case in chosen])


@pytest.fixture(scope="session")
def suite(pytestconfig: pytest.Config) -> tuple[Case, ...]:
    """All charts of the suite."""
    try:
        return _cases(pytestconfig)
    except UnreachableError as error:
        pytest.skip(str(error))


def _cases(config: pytest.Config) -> tuple[Case, ...]:
    kept = getattr(config, "cache", None)
    return _not_kept() if kept is None else cases(kept.mkdir("scxml"))


@cache
def _not_kept() -> tuple[Case, ...]:
    """Return the cases when pytest keeps nothing from run to run."""
    with TemporaryDirectory() as folder:
        return cases(Path(folder))


def _sort(case: Case) -> str:
    if not case.w3c and not beyond_plain(case.chart):
        return "plain"
    return "beyond" if convert(case.chart).beyond else "more"
