from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from samples import HOP
from typer.testing import CliRunner

from missionkit.cli.app import app

Call = Callable[..., Any]


@pytest.fixture
def hop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A short mission, alone in the working directory."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "hop.yaml"
    path.write_text(HOP)
    return path


@pytest.fixture
def call(hop: Path) -> Call:
    """Call `missionkit` with arguments; whatever goes wrong must not be a traceback."""

    def call(*arguments: str) -> Any:
        result = CliRunner().invoke(app, arguments)
        assert result.exception is None or isinstance(result.exception, SystemExit)
        assert "\x1b" not in result.output
        return result

    return call
