"""Haar-like features in a boosted cascade: P4 section III-A; Viola and Jones, 2001."""
