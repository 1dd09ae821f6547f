"""What `missionkit` exports: missions loaded, checked, rehearsed, flown and counted from Python."""
