"""Guard on the time of day."""

from __future__ import annotations

from typing import Annotated, ClassVar, Final, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.plugin import Guard

DAY: Final = 86400.0  # s
Clock = Annotated[str, Field(pattern=r"^([01]\d|2[0-3]):[0-5]\d(:[0-5]\d)?$")]


class TimeOfDay(Guard):
    """Holds from `after` to `before`, over midnight if that is the earlier one.

    `"08:00"` or `"08:00:30"`, in UTC, or in the local time that is `utc_offset` hours ahead of it.
    The time is the vehicle's: SYSTEM_TIME over MAVLink; in the simulator what
    `settings: {date: ...}` says of the start. Unknown while there is none.
    """

    kind: ClassVar[str] = "time_of_day"
    after: Clock = Field(description="when it begins to hold")
    before: Clock = Field(description="when it no longer holds")
    utc_offset: Annotated[float, Field(ge=-12, le=14, json_schema_extra={"unit": "h"})] = Field(
        default=0.0, description="of the local time, east is positive"
    )

    @model_validator(mode="after")
    def _some_time(self) -> Self:
        if seconds(self.after) == seconds(self.before):
            raise ValueError("'after' and 'before' are the same time: it would never hold")
        return self

    @override
    def check(self, seen: Estimate) -> Verdict:
        if seen.utc is None:
            return Verdict.unknown("the time of day is not known")
        now = (seen.utc + 3600.0 * self.utc_offset) % DAY
        begin, end = seconds(self.after), seconds(self.before)
        since, length = (now - begin) % DAY, (end - begin) % DAY
        holds = since < length
        to_begin, to_end = (since, length - since) if holds else (DAY - since, since - length)
        margin = min(to_begin, to_end)
        bound = begin if to_begin <= to_end else end
        why = f"it is {in_words(now)}"
        hour = 3600.0
        return Verdict(holds, why, now / hour, bound / hour, (margin if holds else -margin) / hour)


def seconds(clock: str) -> float:
    """Return the seconds since midnight.

    >>> seconds("08:00"), seconds("23:59:59")
    (28800.0, 86399.0)
    """
    hours, minutes, *rest = map(int, clock.split(":"))
    return 3600.0 * hours + 60.0 * minutes + float(sum(rest))


def in_words(now: float) -> str:
    """Return the seconds since midnight as a time.

    >>> in_words(28830.7)
    '08:00:30'
    """
    whole = int(now)
    return f"{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}"
