"""Herding ground robots over a goal line (P4, V): which one is next."""
