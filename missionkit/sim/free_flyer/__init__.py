"""Simulator of a free flyer: a small satellite that thrusters drive, and its docking target."""
