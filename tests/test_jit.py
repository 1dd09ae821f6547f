"""Kernels are compiled when they are first called."""

from __future__ import annotations

import copy
import subprocess
import sys

from missionkit.planning import rotor_power

VALIDATE = """
import sys
from missionkit.cli.app import app
sys.argv = ["missionkit", "validate", "missions/precision_task.yaml"]
try:
    app()
except SystemExit as end:
    assert not end.code
heavy = {"numba", "cv2", "scipy", "matplotlib", "mavsdk"} & sys.modules.keys()
assert not heavy, heavy
"""


def test_a_command_that_flies_nothing_imports_nothing_that_flies():
    subprocess.run([sys.executable, "-c", VALIDATE], check=True, stdout=subprocess.DEVNULL)


def test_a_kernel_is_copied_by_its_name():  # as it is pickled
    assert copy.deepcopy(rotor_power.induced_velocity) is rotor_power.induced_velocity
