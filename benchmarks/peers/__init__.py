"""State chart engines to compare with, each behind the same few lines: `benchmarks.engine`."""
