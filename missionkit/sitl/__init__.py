"""A simulated autopilot around the simulator's vehicle; it speaks MAVLink 2."""
