"""`python -m missionkit`."""

from missionkit.cli import main

main()
