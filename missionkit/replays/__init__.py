"""Flying recorded flights through a chart again: the same one, or another."""
