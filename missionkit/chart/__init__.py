"""Charts: a mission file is read, checked, and compiled into what the engine runs."""
