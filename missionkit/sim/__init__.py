"""The built-in simulator: world, vehicle, sensors, camera, faults, grading."""
