"""Telemetry: from messages to observations."""
