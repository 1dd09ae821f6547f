"""A filter on the messages from the simulated autopilot to the adapter: alter, drop, add, spoof.

with sitl() as autopilot:
    link = MessageFilter(autopilot)
    link.change("GPS_RAW_INT", cog=65535)
    link.on("BATTERY_STATUS", lambda it: [it, mavlink.MAVLink_battery_status_message(...)])
    link.drop("HOME_POSITION")
    link.inject(mavlink.MAVLink_heartbeat_message(...), system=2)
    link.clear("GPS_RAW_INT")
"""

from __future__ import annotations

import copy

from missionkit.sitl.pymavlink_dialect import mavlink


class MessageFilter:
    """Works on every link that is open when it is made; messages it has no rule for pass.

    Args:
        autopilot: a `Sitl` of `vehicle.flying`.
    """

    def __init__(self, autopilot):
        self._channels = list(autopilot.server.autopilot.state.channels)
        self._rules = {}
        self._senders = {}
        self.passed = {}  # name -> the newest message as it came from the autopilot
        for channel in self._channels:
            channel.send = self._through(channel.send)

    def on(self, name, rule):
        """Send what `rule(message)` returns, in place of each message of a name.

        The message is a copy; its fields may be changed.
        """
        self._rules[name] = rule

    def change(self, name, **fields):
        """Overwrite fields of every message of a name."""

        def overwrite(message):
            for field, value in fields.items():
                assert field in message.fieldnames
                setattr(message, field, value)
            return [message]

        self.on(name, overwrite)

    def drop(self, *names):
        """Let no message of these names pass."""
        for name in names:
            self.on(name, lambda _: [])

    def clear(self, *names):
        """Let messages of these names, or of all, pass as they are."""
        for name in names or tuple(self._rules):
            self._rules.pop(name, None)

    def inject(self, message, system=1, component=1):
        """Send a message now, as if by that system and component."""
        sender = self._senders.setdefault(
            (system, component), mavlink.MAVLink(None, system, component)
        )
        data = message.pack(sender)
        sender.seq = (sender.seq + 1) % 256
        for channel in self._channels:
            channel._write(data)

    def _through(self, send):
        def filtered(message, now):
            name = message.get_type()
            self.passed[name] = message
            rule = self._rules.get(name)
            for each in [message] if rule is None else rule(copy.copy(message)):
                send(each, now)

        return filtered
