"""The page of a flight in progress: a server in a process of its own, and the link to it."""
