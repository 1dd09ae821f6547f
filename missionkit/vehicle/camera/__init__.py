"""The camera: devices, files and streams, and frames with their times."""
