"""The page of a flight: live, of a recording, or of a chart that is played with."""
