"""A small process that owns the link to the autopilot and outlives the mission's process.

It imports the standard library and the dialects alone, so that it starts at once and stays small.
"""

HOLDER = "guardian"  # how a link's lock names a guardian that is alone with it
