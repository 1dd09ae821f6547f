"""Drone missions as YAML state charts."""

__version__ = "0.1.0"
