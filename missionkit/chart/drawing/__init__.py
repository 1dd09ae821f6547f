"""The chart as a picture."""
