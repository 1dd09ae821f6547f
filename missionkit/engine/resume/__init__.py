"""Resuming a flight whose process died: checkpoint, listen first, command later."""
