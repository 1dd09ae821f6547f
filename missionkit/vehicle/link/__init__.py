"""The link: addresses, connection, heartbeats, clocks, and which messages are trusted."""
