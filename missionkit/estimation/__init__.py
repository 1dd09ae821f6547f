"""Filters: where the vehicle and its targets are, and how far that can be trusted."""
