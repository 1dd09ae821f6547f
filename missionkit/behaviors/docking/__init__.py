"""Docking of a free flyer: P3's three stages, the way in, and the safe end."""
