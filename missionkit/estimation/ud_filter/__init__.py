"""A Kalman filter on the factors of its covariance: Bierman's update, Thornton's prediction."""
