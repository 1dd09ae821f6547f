"""Logs of autopilots and ground stations: ULog, tlog and ArduPilot's dataflash, as records."""
