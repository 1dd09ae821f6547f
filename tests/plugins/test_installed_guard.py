"""A guard of somebody else's, in a package of its own, flown."""

from __future__ import annotations

import importlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from rehearsed import Flight, flown, short_stage

from missionkit.api.missions import assemble
from missionkit.chart.plugin_catalogue import Catalogue, builtin, source
from missionkit.cli.scaffold import new
from missionkit.engine.flight_end import FlightEnd
from missionkit.errors import FileError, UsageError
from missionkit.geometry import norm

MISSION = """\
targets: {place: {position: [40, 0, -3]}}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 3}, transitions: [{to: out, when: done}]}
  out:
    kind: gps
    behavior: {use: go_to, target: place, speed: 4}
    transitions: [{to: return, when: {use: too_fast, limit: 2.5}}]
  return:
    kind: return
    behavior: {use: go_to, target: home, height: 3}
    transitions: [{to: land, when: done}]
  land: {kind: land}
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    """The folder of a package as `missionkit new guard too_fast` writes it."""
    folder = tmp_path_factory.mktemp("written")
    new("guard", "too_fast", folder)
    return folder / "missionkit-too-fast"


@pytest.fixture(scope="module")
def site(written: Path, tmp_path_factory) -> Path:
    """Where pip installed it, away from this environment."""
    site = tmp_path_factory.mktemp("site")
    offline = ("--no-index", "--no-deps", "--no-build-isolation", "--disable-pip-version-check")
    subprocess.run(
        [sys.executable, "-m", "pip", "install", "-q", *offline, "--target", site, written],
        check=True,
        capture_output=True,
        timeout=120,
    )
    return site


@pytest.fixture
def installed(site: Path, monkeypatch) -> Iterator[Catalogue]:
    monkeypatch.syspath_prepend(str(site))
    importlib.invalidate_caches()
    yield assemble()
    sys.modules.pop("missionkit_too_fast", None)


def check(flight: Flight) -> None:
    """The guard turned the flight round as soon as the vehicle was too fast."""
    assert flight.went() == [
        ("out", "when done"),
        ("return", "when too fast (limit 2.5)"),
        ("land", "when done"),
    ]
    assert flight.result.flown.end is FlightEnd.LANDED
    assert flight.result.grade.landed
    turned = next(record for record in flight.records if record.state == "return")
    ((name, verdict),) = turned.fired[0].verdicts
    assert (name, verdict.holds, verdict.threshold) == ("too fast (limit 2.5)", True, 2.5)
    assert verdict.value == pytest.approx(norm(turned.estimate.velocity))
    assert flight.problems() == []


def test_an_installed_guard_is_found_and_flown(installed: Catalogue):
    assert source(installed.group("guards")["too_fast"]) == "missionkit_too_fast.TooFast"
    check(flown(short_stage(MISSION, catalogue=installed)))


def test_a_guard_in_a_file_is_flown_without_installing(written: Path):
    catalogue = assemble([written / "missionkit_too_fast.py"])
    check(flown(short_stage(MISSION, catalogue=catalogue)))


def test_installed_and_given_as_a_file_is_one_too_many(installed: Catalogue, written: Path):
    with pytest.raises(UsageError, match="two guards are called 'too_fast'"):
        assemble([written / "missionkit_too_fast.py"])


def test_without_the_package_its_name_is_unknown():
    assert "too_fast" not in builtin().group("guards")
    with pytest.raises(FileError, match="too_fast"):
        short_stage(MISSION)
