"""SARIF logs against the schema that OASIS published, fetched once from npm, never committed."""

from __future__ import annotations

import hashlib
import json
import subprocess
import tarfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from documents import ROOT
from jsonschema.validators import validator_for

PACKAGE = "@microsoft/jest-sarif@1.0.0-beta.0"
ARCHIVE = "microsoft-jest-sarif-1.0.0-beta.0.tgz"
SHA256 = "748e2c3d1a842e7bb258416685c7ea3a0da40005b72267b2052c2856d48ad102"
SCHEMA = "package/lib/schemas/sarif-2.1.0-rtm.5.json"
PATIENCE = 120.0  # s to fetch the package


@pytest.fixture(scope="module")
def schema(pytestconfig: pytest.Config) -> Any:
    """The official schema; without a way to npm the tests are skipped."""
    kept = pytestconfig.cache.mkdir("sarif") / ARCHIVE
    if not kept.exists():
        with TemporaryDirectory(dir=kept.parent) as fresh:
            _fetch(Path(fresh))
            (Path(fresh) / ARCHIVE).replace(kept)
    assert hashlib.sha256(kept.read_bytes()).hexdigest() == SHA256
    with tarfile.open(kept) as tar:
        file = tar.extractfile(SCHEMA)
        assert file is not None
        return json.load(file)


def _fetch(folder: Path) -> None:
    command = ["npm", "pack", PACKAGE, "--pack-destination", str(folder)]
    try:
        subprocess.run(command, cwd=folder, capture_output=True, timeout=PATIENCE, check=True)
    except (OSError, subprocess.SubprocessError) as error:
        pytest.skip(f"the schema cannot be fetched: {error}")


def errors(log: Any, schema: Any) -> list[str]:
    kind = validator_for(schema)
    return [error.message for error in kind(schema).iter_errors(log)]


def test_every_broken_mission_gives_a_valid_log(schema, call):
    files = sorted(str(path) for path in (ROOT / "tests" / "broken").glob("*.yaml"))
    mission = str(ROOT / "missions" / "precision_task.yaml")
    log = json.loads(call("validate", *files, mission, "--format", "sarif").stdout)
    assert len(log["runs"][0]["results"]) >= len(files)
    assert errors(log, schema) == []


def test_a_log_without_problems_is_valid(schema, call):
    log = json.loads(call("validate", "hop.yaml", "--format", "sarif").stdout)
    assert log["runs"][0]["results"] == []
    assert errors(log, schema) == []


def test_the_schema_refuses_a_wrong_log(schema, call):
    log = json.loads(call("validate", "none.yaml", "--format", "sarif").stdout)
    log["runs"][0]["results"][0]["level"] = "fatal"
    assert len(errors(log, schema)) == 1
