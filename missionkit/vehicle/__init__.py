"""Vehicles over MAVLink: the port `Vehicle` on top of MAVSDK, which nothing else imports."""
