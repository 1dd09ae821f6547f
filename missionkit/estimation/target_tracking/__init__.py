"""Tracking of ground robots from the air: models of motion, filters over them, many targets."""
