"""Upload, download and clearing of missions, fences and rally points.

https://mavlink.io/en/services/mission.html: MISSION_COUNT, then one MISSION_REQUEST_INT and one
MISSION_ITEM_INT for each item, then MISSION_ACK. A request that is not answered is repeated.

ArduPilot asks by MISSION_REQUEST, unless the station says that it cannot answer that, and item 0 of
its mission is home, also of an empty one (`MissionItemProtocol.cpp`,
`MissionItemProtocol_Waypoints.cpp`, `AP_Mission.cpp`).
"""

from __future__ import annotations

from dataclasses import dataclass, field

from missionkit.sitl import guided_items
from missionkit.sitl.peer_channel import Channel, Sender, sender
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.sitl_state import SitlState
from missionkit.sitl.stored_plans import MISSION_ITEMS, Item

RETRY_INTERVAL, RETRIES = 0.25, 10  # s
MISSION_ACCEPTED = mavlink.MAV_MISSION_ACCEPTED


@dataclass(slots=True)
class Upload:
    """An upload under way."""

    channel: Channel
    who: Sender
    kind: int  # MAV_MISSION_TYPE
    count: int
    items: list[Item] = field(default_factory=list)
    asked_at: float = 0.0
    tries: int = 0
    by_integers: bool = True  # the station is asked for MISSION_ITEM_INT


class MissionProtocol:
    """The autopilot's side."""

    def __init__(self) -> None:
        self._upload: Upload | None = None

    def hear(self, state: SitlState, channel: Channel, message: Message) -> None:
        """Answer a message of the mission protocol.

        Args:
            state: of the autopilot; its plans are changed.
            channel: on which the message came, and the answer goes.
            message: of the mission protocol; an acknowledgement is not answered.
        """
        who = sender(message)
        kind = getattr(message, "mission_type", MISSION_ITEMS)
        match message.get_type():
            case "MISSION_REQUEST_LIST":
                count = len(state.plans.items.get(kind, ()))
                channel.send(mavlink.MAVLink_mission_count_message(*who, count, kind), state.now)
            case "MISSION_REQUEST" | "MISSION_REQUEST_INT":
                _give(state, channel, message, kind)
            case "MISSION_CLEAR_ALL":
                _clear(state, kind)
                _acknowledge(state, channel, who, MISSION_ACCEPTED, kind)
            case "MISSION_SET_CURRENT":
                set_current(state, message.seq)
            case "MISSION_COUNT":
                px4 = state.dialect.name == "px4"
                self._begin(state, Upload(channel, who, kind, message.count, by_integers=px4))
            case "MISSION_ITEM" | "MISSION_ITEM_INT":
                self._take(state, channel, message)
            case "MISSION_ACK" if message.type == mavlink.MAV_MISSION_UNSUPPORTED:
                self._ask_by_integers(state, who)
            case _:
                pass  # MISSION_ACK ends a download

    def _begin(self, state: SitlState, upload: Upload) -> None:
        if upload.kind not in state.plans.items:
            refused = mavlink.MAV_MISSION_UNSUPPORTED
            _acknowledge(state, upload.channel, upload.who, refused, upload.kind)
            return
        self._upload = upload
        self._advance(state, upload)

    def _take(self, state: SitlState, channel: Channel, message: Message) -> None:
        upload, who = self._upload, sender(message)
        if guided_items.is_guided(state, message.current):
            single = Item.of(message)
            flown = mavlink.MAV_MISSION_INVALID_PARAM5_X
            if single is not None:
                flown = guided_items.fly(state, channel, who, single)
            _acknowledge(state, channel, who, flown, MISSION_ITEMS)
            return
        if upload is None or who != upload.who:
            return
        item = Item.of(message)
        if item is None:
            self._end(state, upload, mavlink.MAV_MISSION_INVALID_PARAM5_X)
            return
        if message.seq == len(upload.items):
            upload.items.append(item)
            upload.tries = 0
        self._advance(state, upload)

    def _advance(self, state: SitlState, upload: Upload) -> None:
        if len(upload.items) < upload.count:
            self._ask(state, upload)
            return
        _store(state, upload.kind, tuple(upload.items))
        self._end(state, upload, MISSION_ACCEPTED)

    def _end(self, state: SitlState, upload: Upload, result: int) -> None:
        _acknowledge(state, upload.channel, upload.who, result, upload.kind)
        self._upload = None

    def _ask(self, state: SitlState, upload: Upload) -> None:
        upload.asked_at, upload.tries = state.now, upload.tries + 1
        ask = mavlink.MAVLink_mission_request_message
        if upload.by_integers:
            ask = mavlink.MAVLink_mission_request_int_message
        upload.channel.send(ask(*upload.who, len(upload.items), upload.kind), state.now)

    def _ask_by_integers(self, state: SitlState, who: Sender) -> None:
        upload = self._upload
        if upload is not None and upload.who == who and not upload.by_integers:
            upload.by_integers = True
            self._ask(state, upload)

    def step(self, state: SitlState) -> None:
        """Ask again for an item that did not come; give up after some time."""
        upload = self._upload
        if upload is None or state.now - upload.asked_at < RETRY_INTERVAL:
            return
        if upload.tries < RETRIES:
            self._ask(state, upload)
            return
        self._end(state, upload, mavlink.MAV_MISSION_OPERATION_CANCELLED)


def _acknowledge(state: SitlState, channel: Channel, who: Sender, result: int, kind: int) -> None:
    channel.send(mavlink.MAVLink_mission_ack_message(*who, result, kind), state.now)


def _give(state: SitlState, channel: Channel, message: Message, kind: int) -> None:
    who, items = sender(message), state.plans.items.get(kind, ())
    if kind == MISSION_ITEMS and message.seq == 0 and state.dialect.name == "ardupilot":
        items = (_home(state), *items[1:])
    if message.seq >= len(items):
        _acknowledge(state, channel, who, mavlink.MAV_MISSION_INVALID_SEQUENCE, kind)
        return
    item = items[message.seq]
    current = int(message.seq == state.plans.current)
    head = (*who, message.seq, item.frame, item.command, current, item.autocontinue, *item.params)
    if message.get_type() == "MISSION_REQUEST_INT":
        place = (item.x, item.y, item.z)
        answer = mavlink.MAVLink_mission_item_int_message(*head, *place, kind)
    else:
        place = (item.x / 1e7, item.y / 1e7, item.z)
        answer = mavlink.MAVLink_mission_item_message(*head, *place, kind)
    channel.send(answer, state.now)


def _home(state: SitlState) -> Item:
    spot = state.earth.spot(state.home)
    return Item(
        mavlink.MAV_FRAME_GLOBAL,
        mavlink.MAV_CMD_NAV_WAYPOINT,
        current=0,
        autocontinue=1,
        params=(0.0, 0.0, 0.0, 0.0),
        x=round(1e7 * spot.latitude),
        y=round(1e7 * spot.longitude),
        z=spot.height,
    )


def _clear(state: SitlState, kind: int) -> None:
    kinds = list(state.plans.items) if kind == mavlink.MAV_MISSION_TYPE_ALL else [kind]
    for each in kinds:
        _store(state, each, ())


def _store(state: SitlState, kind: int, items: tuple[Item, ...]) -> None:
    state.plans.items[kind] = items
    if kind == MISSION_ITEMS:
        state.plans.current, state.plans.reached = 0, -1


def set_current(state: SitlState, seq: int) -> bool:
    """Go on with another item; return whether there is one."""
    if not 0 <= seq < len(state.plans.mission):
        return False
    state.plans.current = seq
    if state.mode.does.value == "mission":
        state.begin("")
    return True
