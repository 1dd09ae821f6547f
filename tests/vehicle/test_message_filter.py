"""The filter between simulated autopilot and adapter does what tests rely on."""

from vehicle.flying import over_the_wire
from vehicle.message_filter import MessageFilter

from missionkit.sitl.pymavlink_dialect import mavlink


def test_it_alters_drops_adds_and_spoofs(tmp_path):
    async def look(flight, autopilot):
        link, cache = MessageFilter(autopilot), flight.vehicle.cache
        await flight.ready()
        link.change("GPS_RAW_INT", satellites_visible=77)
        link.on("SYS_STATUS", lambda it: [it, mavlink.MAVLink_statustext_message(6, b"added")])
        link.drop("BATTERY_STATUS")
        await flight.until(lambda: cache.latest("GPS_RAW_INT")["satellites_visible"] == 77)
        await flight.until(lambda: "status.info.added" in flight.events)
        last = cache.latest("BATTERY_STATUS").arrived
        await flight.until(lambda: (cache.wall() - last) * autopilot.speed > 5.0)
        link.inject(mavlink.MAVLink_statustext_message(4, b"spoofed"))
        link.inject(mavlink.MAVLink_statustext_message(4, b"stranger"), system=9)
        await flight.until(lambda: "status.warning.spoofed" in flight.events)
        link.clear()
        assert link.passed["GPS_RAW_INT"].satellites_visible != 77
        await flight.until(lambda: cache.latest("GPS_RAW_INT")["satellites_visible"] != 77)
        await flight.until(lambda: cache.latest("BATTERY_STATUS").arrived > last)
        assert "status.warning.stranger" not in flight.events

    over_the_wire(tmp_path, look)
