"""Facts about ground robots, by the name that they had here."""

from missionkit.ground_robot import GroundRobot

__all__ = ["GroundRobot"]
