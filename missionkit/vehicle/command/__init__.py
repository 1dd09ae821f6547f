"""Commands: who commands, setpoints, orders to the autopilot, the payload."""
