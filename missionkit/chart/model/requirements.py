"""Requirements of a mission: Dwyer's patterns with scope and time bound, made of its guards.

Source: M. B. Dwyer, G. S. Avrunin, J. C. Corbett, "Patterns in Property Specifications for
Finite-State Verification", ICSE 1999: absence, universality, existence, precedence, response.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.guard_parser import Condition, parse
from missionkit.chart.model.model_base import NAMES_KEY, GuardName, MissionPart, StateName
from missionkit.chart.text.located_data import LocatedTable, shown
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.units import Seconds

Pattern = Literal["never", "always", "existence", "precedence", "response"]
PATTERNS: tuple[Pattern, ...] = ("never", "always", "existence", "precedence", "response")
Moment = ex.Expression | ex.Enter


class MomentField:
    """Marks a field that holds a guard, or `{enter: state}`."""

    says = "a guard, or {enter: state}"

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Parse it."""

        def validate(data: object, info: core_schema.ValidationInfo[Any]) -> Moment:
            if not isinstance(data, LocatedTable) or "enter" not in data or "hysteresis" in data:
                return parse(data, info.context)
            name, known = data["enter"], info.context.states
            odd = next((key for key in data if key != "enter"), None)
            if odd is not None:
                raise sentences(sentence(f"unknown key {odd!r} beside 'enter'", odd, at_key=True))
            if not isinstance(name, str) or name not in known:
                unknown = f"unknown state {shown(name)}"
                raise sentences(sentence(unknown, "enter", word=str(name), known=known))
            return ex.Enter(str(name), data.place)

        return core_schema.with_info_plain_validator_function(validate)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Allow what a guard allows, and the entry of a state."""
        enter = {
            "type": "object",
            "description": ex.Enter.__doc__,
            "properties": {"enter": {"type": "string", NAMES_KEY: "state"}},
            "required": ["enter"],
            "additionalProperties": False,
        }
        return {"anyOf": [{"x-plugin": "guards"}, enter]}


MomentOf = Annotated[Moment, MomentField]


class Response(MissionPart):
    """What must follow when something has happened."""

    when: MomentOf = Field(description="what calls for it")
    then: MomentOf = Field(description="what must follow")
    within: Seconds | None = Field(default=None, description="by when it must have followed")


class Broken(MissionPart):
    """Where a broken requirement leads, like a broken invariant."""

    to: StateName = Field(description="state to go to")
    after: Seconds = Field(default=0.0, description="how long it may be broken")


class Requirement(MissionPart):
    """A requirement: one of never, always, existence, precedence and response."""

    name: GuardName
    never: MomentOf | None = Field(default=None, description="must not happen")
    always: Condition | None = Field(default=None, description="must hold all the time")
    existence: MomentOf | None = Field(default=None, description="must happen")
    precedence: MomentOf | None = Field(
        default=None, description="must have happened when what 'before' names happens"
    )
    response: Response | None = Field(default=None, description="what must follow what")
    while_: Condition | None = Field(
        default=None, alias="while", description="counts only while this holds"
    )
    after: MomentOf | None = Field(default=None, description="counts from when this happens")
    before: MomentOf | None = Field(default=None, description="counts until this happens")
    within: Seconds | None = Field(default=None, description="time bound, from where it counts")
    broken: Broken | None = Field(default=None, description="where it leads when it is broken")

    @model_validator(mode="after")
    def _one_pattern(self) -> Self:
        given = [word for word in PATTERNS if getattr(self, word) is not None]
        if len(given) != 1:
            got = " and ".join(map(repr, given)) or "none of them"
            raise sentences(sentence(f"expected one of {', '.join(PATTERNS)}, got {got}"))
        if self.precedence is not None and self.before is None:
            raise sentences(sentence("'precedence' needs 'before': what it must come before"))
        if self.response is not None and self.within is not None:
            message = "'response' has its own 'within': write it inside"
            raise sentences(sentence(message, "within", at_key=True))
        return self

    @property
    def pattern(self) -> Pattern:
        """Which of the patterns it is."""
        return next(word for word in PATTERNS if getattr(self, word) is not None)

    @property
    def limit(self) -> float | None:
        """The time bound (s), wherever it is written."""
        return self.within if self.response is None else self.response.within

    def guards(self) -> tuple[ex.Expression, ...]:
        """Return every guard that it is made of."""
        return tuple(part for part in self.moments() if not isinstance(part, ex.Enter))

    def moments(self) -> tuple[Moment, ...]:
        """Return every guard and entry that it is made of."""
        answered = () if self.response is None else (self.response.when, self.response.then)
        parts = (self.never, self.always, self.existence, self.precedence, *answered)
        scope = (self.while_, self.after, self.before)
        return tuple(part for part in (*parts, *scope) if part is not None)
