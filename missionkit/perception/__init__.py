"""From image to relative pose: P1 sections 2 and 5. The only importer of OpenCV."""

import os

# Read by OpenCV when it is loaded: a small file may claim to hold an image of gigabytes.
os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", "100000000")
