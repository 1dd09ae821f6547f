"""Sense, decide, act: the pure tick, and the shell around it."""
