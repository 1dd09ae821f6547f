"""Compile what the shipped missions fly with: once, beside the type checker, before the tests."""

from documents import ROOT

import missionkit
from missionkit.rehearsal import stage, world_of

if __name__ == "__main__":
    for path in sorted((ROOT / "missions").glob("*.yaml")):
        mission = missionkit.load(path)
        stage(mission.model, mission.catalogue, world_of(mission.model, path.parent), 0)
