"""Planning: potential field, search patterns."""
