"""The chart in plain sentences."""
