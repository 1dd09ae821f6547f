"""Docking of a free flyer: P3's three stages, the way in, and the safe end."""

from missionkit.behaviors.docking.align import Align, LookAt
from missionkit.behaviors.docking.approach import Approach
from missionkit.behaviors.docking.dock import Dock
from missionkit.behaviors.docking.reorient import Reorient
from missionkit.behaviors.docking.secure import Secure

DOCKING = (Align, Approach, Dock, LookAt, Reorient, Secure)
