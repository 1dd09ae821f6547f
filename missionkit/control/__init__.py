"""Control: PID, yaw law, smoothing, limits."""
