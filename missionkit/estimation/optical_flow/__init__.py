"""The optical-flow navigator: a Kalman filter per axis, without satellites or camera."""
