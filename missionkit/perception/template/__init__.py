"""Template matching by normalised cross-correlation: P4 section III-A."""
