"""From image to relative pose: P1 sections 2 and 5. The only importer of OpenCV."""
