"""Public API of `missionkit`: load, check, rehearse, fly and run campaigns from Python."""
