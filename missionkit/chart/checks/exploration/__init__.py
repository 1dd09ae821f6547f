"""Everything that a chart can do, found by the engine's own selection of transitions."""
