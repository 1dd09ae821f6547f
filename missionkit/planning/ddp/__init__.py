"""Differential dynamic programming over a receding horizon (P4, section IV)."""
