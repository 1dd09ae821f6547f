"""What a run leaves behind: the flight record (MCAP), `summary.json` and `track.png`."""
