"""Each file in tests/checks has exactly the findings that the .txt beside it holds.

`pytest tests/checks/test_findings.py --update-refs` writes the .txt files.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from missionkit.chart.checks import findings
from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import Level, Problem

ENDURANCE = 450.0  # s, that of the simulated vehicle
SIGHT = 12.0  # m, that of the simulated scanner
FOLDER = Path(__file__).parent
FILES = sorted(path.name for path in FOLDER.glob("*.yaml"))


def line_of(problem: Problem) -> str:
    head = f"{problem.place}: {problem.level}[{problem.code}]: {problem.message}"
    return f"{head}\n  help: {problem.remedy}\n"


@pytest.mark.parametrize("name", FILES)
def test_findings(name: str, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch, update_refs):
    monkeypatch.chdir(FOLDER)
    mission = load(Path(name), catalogue)
    found = findings(mission, catalogue, endurance=ENDURANCE, sight=SIGHT)
    assert all(it.place.line > 1 and it.code and it.remedy and it.level in Level for it in found)
    report = "".join(map(line_of, found))
    if update_refs:
        Path(name).with_suffix(".txt").write_text(report)
    assert report == Path(name).with_suffix(".txt").read_text()


def test_every_code_is_in_the_reference():
    text = (FOLDER.parents[1] / "docs" / "reference" / "checks.md").read_text()
    table = set(re.findall(r"^\| `([a-z-]+)` \|", text, re.MULTILINE))
    shown = {
        code
        for path in FOLDER.glob("*.txt")
        for code in re.findall(r": (?:error|warning)\[([a-z-]+)\]: ", path.read_text())
    }
    assert table == shown | {"too-many-to-compare", "unproven"}


def test_every_file_has_its_findings():
    assert {Path(name).stem for name in FILES} == {path.stem for path in FOLDER.glob("*.txt")}
