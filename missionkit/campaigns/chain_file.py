"""A campaign's Markov chain as a file that guards read: `missionkit campaign ... --chain FILE`."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from missionkit.campaigns.analysis import Analysis
from missionkit.campaigns.markov_chain import Chain
from missionkit.errors import UsageError
from missionkit.guards.estimated_chain import MOST_STATES

RESERVED = frozenset({"null", "true", "false"})  # words that YAML does not read as text


def write_chain(path: Path, analysis: Analysis) -> None:
    """Write the chain of a campaign that flew one variant.

    Raises:
        UsageError: it flew several, or none of its runs gave a flight; or the file cannot be
            written.
    """
    if len(analysis.variants) != 1:
        raise UsageError("--chain writes the chain of one variant; leave out --vary")
    (variant,) = analysis.variants
    if not variant.chain.states:
        raise UsageError(f"{path}: no run gave a flight, so there is no chain to write")
    text = chain_text(variant.chain, analysis.campaign.name, analysis.campaign.settings)
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{path}: the chain cannot be written: {error.strerror}") from error


def chain_text(chain: Chain, mission: str, settings: Mapping[str, str]) -> str:
    """Return a chain as the text of its file: `guards.estimated_chain.EstimatedChain`.

    An ending leads to where flights begin, as if the next one began at once.

    Args:
        chain: counts of the flights.
        mission: name of the mission.
        settings: values of its parameters that were set for the flights.

    Raises:
        UsageError: the chain has too many states for a guard.
    """
    outcomes = sorted({ending.outcome for ending in chain.endings})
    endings = [f"ended_{it}" if it in chain.states else it for it in outcomes]
    states = [*chain.states, *endings]
    if len(states) > MOST_STATES:
        raise UsageError(f"a chain of {len(states)} states; a guard reads at most {MOST_STATES}")
    ended = np.array([[it.outcome == outcome for outcome in outcomes] for it in chain.endings])
    rows = np.hstack([chain.inner, chain.outer @ ended]).tolist()
    start = [*(chain.starts / chain.starts.sum()).tolist(), *[0.0] * len(endings)]
    rows += [start] * len(endings)
    flights = int(chain.starts.sum())
    given = ", ".join(f"{name} = {value}" for name, value in settings.items())
    dwell = zip(chain.states, chain.dwell.tolist(), strict=True)
    return "\n".join(
        [
            f"# The chart of {mission} as a Markov chain, from {flights} flights in the simulator.",
            *([f"# With {given}."] if given else []),
            "# Rows lead to columns; a flight that ends begins again where flights begin.",
            "chain: 1",
            f"mission: {_quoted(mission)}",
            f"flights: {flights}",
            f"states: {_listed(map(_quoted, states))}",
            f"endings: {_listed(map(_quoted, endings))}",
            "matrix:",
            *(f"  - {_listed(map(_number, row))}" for row in rows),
            "dwell:  # s, mean of a visit",
            *(f"  {_quoted(state)}: {_number(round(seconds, 3))}" for state, seconds in dwell),
            "",
        ]
    )


def _listed(words: Iterable[str]) -> str:
    return f"[{', '.join(words)}]"


def _quoted(name: str) -> str:
    return json.dumps(name) if name.lower() in RESERVED or not name[:1].isalpha() else name


def _number(value: float) -> str:
    return f"{value:g}" if float(f"{value:g}") == value else repr(value)
