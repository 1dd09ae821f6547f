"""Pre-flight: what a vehicle says about itself, judged, and made safe."""
