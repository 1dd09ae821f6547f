"""What a mission file may say, as models, and what must be true of it."""
