"""The visual-inertial navigator: an error-state Kalman filter with delayed measurements."""
