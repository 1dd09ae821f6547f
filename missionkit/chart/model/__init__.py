"""Models of the mission file, and the rules it must satisfy."""
