"""The version of missionkit, which every run, campaign and report writes down."""

from typing import Final

__version__: Final = "0.1.0"
