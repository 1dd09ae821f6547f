"""Rehearsals: a mission flown in the built-in simulator, and graded by ground truth."""
