"""Plan of a campaign, kept as `campaign.json` in its folder so that it can be resumed."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from missionkit.campaigns.run_row import Case, RunOrder
from missionkit.campaigns.variants import Axis, variants
from missionkit.chart.model.mission import Mission
from missionkit.errors import UsageError
from missionkit.recorder.checkpoint import write_surely
from missionkit.version import __version__

PLAN_FILE = "campaign.json"


class Rule(BaseModel):
    """When to stop before all runs are flown."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid")

    width: float | None = None  # of the success rate's interval
    require: float | None = None  # success rate to be exceeded
    better: float | None = None  # a rate good enough to be recognised; half the failures if absent
    risk: float = 0.05  # of either wrong decision

    @property
    def idle(self) -> bool:
        """Whether all runs are flown in any case."""
        return self.width is None and self.require is None

    @property
    def hoped(self) -> float:
        """The alternative rate that the required one is tested against."""
        return (1.0 + (self.require or 0.0)) / 2 if self.better is None else self.better


class Campaign(BaseModel):
    """Everything that decides what is flown and when to stop."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid")

    missionkit: str = __version__
    mission: str  # path
    name: str  # of the mission
    settings: dict[str, str] = {}
    plugins: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    events: tuple[str, ...] = ()  # of the operator
    vary: tuple[Axis, ...] = ()
    seed: int = 0
    runs: int  # of each variant
    timeout: float = 300.0  # s of wall time a run may take
    rule: Rule = Rule()
    digest: str  # of the texts that are flown
    records: bool = False

    @property
    def variants(self) -> int:
        """How many variants are flown."""
        return len(variants(self.vary))

    def order(self, folder: Path) -> RunOrder:
        """Return the settings for the workers."""
        records = str((folder / "records").resolve()) if self.records else ""
        return RunOrder(
            self.mission, self.settings, self.plugins, self.faults, self.events, records
        )

    def cases(self) -> Iterator[Case]:
        """Yield all runs; those of one seed, a variant each, follow one another."""
        settings = variants(self.vary)
        for n in range(self.runs):
            for v, chosen in enumerate(settings):
                yield Case(n * len(settings) + v, v, self.seed + n, chosen)


def digest_of(mission: Mission, path: Path, plugins: tuple[Path, ...] = ()) -> str:
    """Return one number for all files that a campaign stands on.

    Args:
        mission: loaded from `path`; its included files and its world count too.
        path: of the mission file, whose folder the names of the others are relative to.
        plugins: files with plug-ins, of which every byte counts.

    Returns:
        SHA-256 in hexadecimal digits.

    Raises:
        OSError: a file cannot be read.
    """
    root = path.resolve().parent
    world = () if mission.world is None else (root / mission.world,)
    total = hashlib.sha256()
    for file in (path, *mission.included, *world, *plugins):
        text = Path(file).read_bytes()
        total.update(b"%d\n%b" % (len(text), text))
    return total.hexdigest()


def keep(folder: Path, campaign: Campaign) -> None:
    """Write it into the folder, whole or not at all."""
    write_surely(folder / PLAN_FILE, campaign.model_dump_json(indent=2) + "\n")


def found(folder: Path) -> Campaign:
    """Return the campaign that a folder holds.

    Raises:
        UsageError: it holds none.
    """
    path = folder / PLAN_FILE
    if not path.is_file():
        raise UsageError(f"{folder}: holds no {PLAN_FILE}: not a campaign folder")
    try:
        return Campaign.model_validate_json(path.read_text(encoding="utf-8"))
    except (ValidationError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: cannot be used: {error}") from error
