"""A mission's map is a part of what a run stands on."""

from __future__ import annotations

import shutil

import cv2
import numpy as np
from rehearsed import MISSIONS

from missionkit.api.run_origin import differences, origin_of, stamp
from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.recorder.checkpoint import opened, sealed


def origin(path):
    return origin_of(load(path, builtin()), path)


def test_another_map_makes_another_mission(tmp_path):
    folder = shutil.copytree(MISSIONS, tmp_path / "missions")
    path, image = folder / "known_map.yaml", folder / "maps" / "two_walls.png"
    first = origin(path)
    assert {"maps/two_walls.yaml", "maps/two_walls.png"} <= first.texts.keys()
    assert opened(sealed(first)) == first  # texts among its parameters too
    assert stamp(origin(path)) == stamp(first)
    cv2.imwrite(str(image), np.full((120, 100), 254, np.uint8))
    changed = origin(path)
    assert stamp(changed) != stamp(first)
    lines = list(differences(first, changed))
    assert lines[0] == "--- maps/two_walls.png (as flown)"
    assert len(lines) == 5
    assert all(line[1:].split()[1:3] == ["bytes,", "SHA-256"] for line in lines[3:])
