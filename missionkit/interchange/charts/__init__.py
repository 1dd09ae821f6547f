"""State charts of other programs: SCXML, and the JSON of XState by way of it."""
