"""Studies: missions flown over many seeds and graded by ground truth."""
