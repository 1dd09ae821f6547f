"""Map tiles from a file: nothing is fetched from anywhere."""
