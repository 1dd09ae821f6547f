"""Output of a run: the flight record (MCAP), `summary.json` and `track.png`."""
