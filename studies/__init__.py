"""What missions are worth, flown over many seeds and graded by ground truth."""
