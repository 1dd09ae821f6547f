"""From pydantic's errors to problems with a place in the file.

A validator that finds something wrong raises `sentences(...)`: pydantic prefixes the path as the
error travels outwards, and `problems_in` looks the whole path up in the document.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import InitErrorDetails

from missionkit.chart.model.validation_text import describe
from missionkit.chart.text.located_data import key_at, place_at, written_path
from missionkit.chart.text.location_text import location_text
from missionkit.chart.text.mistake import (
    MAX_HINTS,
    Mistake,
    Path,
    carried,
    sentences,
)
from missionkit.errors import Place, Problem

M = TypeVar("M", bound=BaseModel)


def plain(model: type[M], data: object, context: object = None) -> M:
    """Validate plain data as strictly as JSON: no number from a text, no truth from a number.

    Args:
        model: of the data.
        data: plain, as read from a file.
        context: for the validators, such as the scope of the mission.

    Raises:
        ValidationError: what is wrong, in sentences.
    """
    try:
        return model.model_validate_json(json.dumps(data), strict=True, context=context)
    except ValidationError as error:
        found = [carried(what, path) for path, what in error_details(error, model, data)]
        raise sentences(*found) from error


def problems_in(
    error: ValidationError,
    model: type[BaseModel],
    data: object,
    start: Place,
    origins: Mapping[Place, str],
) -> list[Problem]:
    """Return the problems that an error of `model` on `data` amounts to, one for each place.

    Args:
        error: what pydantic raised.
        model: the model of the whole document.
        data: the document, parameters replaced.
        start: where to point when there is nothing better.
        origins: places whose value came from a parameter, and the parameter's name.
    """
    found: dict[Path, tuple[Place, Mistake]] = {}
    for path, what in error_details(error, model, data):
        place = (key_at if what.at_key else place_at)(data, path, start)
        found.setdefault(path, (place, what))
    inside = sorted(found.items(), key=lambda item: (item[1][0].line, item[1][0].column))
    return [
        Problem(place, _told(data, path, what, origins.get(place), hinted=at < MAX_HINTS))
        for at, (path, (place, what)) in enumerate(inside)
    ]


def _told(data: object, path: Path, what: Mistake, origin: str | None, *, hinted: bool) -> str:
    above = location_text(data, path)
    message = what.full() if hinted else what.message
    message = message.removeprefix(f"{above.partition(' ')[2]}: ")
    source = f" (from ${origin})" if origin else ""
    return f"{above}: {message}{source}" if above else message + source


def error_details(
    error: ValidationError, model: type[BaseModel], data: object
) -> Iterator[tuple[Path, Mistake]]:
    """Yield path and sentence for each error of `model` on `data`.

    Args:
        error: raised by `model`.
        model: for the names of its fields and the units in its messages.
        data: as it was written; paths are those of the text, not of the model.
    """
    items = error.errors(include_url=False)
    for item in items:
        if item["type"] == "too_short" and any(_inside(it["loc"], item["loc"]) for it in items):
            continue  # items that are wrong were not counted
        path = written_path(data, item["loc"])
        carries = item["type"] == "mistake"
        yield path, item["ctx"]["sentence"] if carries else describe(item, model, path)


def _inside(inner: Path, outer: Path) -> bool:
    return len(inner) > len(outer) and inner[: len(outer)] == outer


def relocated(error: ValidationError, path: Path) -> list[InitErrorDetails]:
    """Return an error's sentences with `path` in front of theirs."""
    return [
        carried(item["ctx"]["sentence"], (*path, *item["loc"]))
        for item in error.errors(include_url=False)
    ]
