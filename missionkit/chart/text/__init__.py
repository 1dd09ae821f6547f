"""Text to data that knows its place: YAML, parameters, includes."""
