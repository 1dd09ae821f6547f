"""Writing a trained cascade: YAML that is JSON as well, a feature a line."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

from missionkit.perception.haar.cascade import HaarCascade
from missionkit.perception.haar.features import SIDE
from missionkit.perception.haar.training import INNER, TrainedStage
from missionkit.perception.score_law import ScoreLaw

DIGITS = 6


def cascade_of(
    stages: Sequence[TrainedStage], diameter: float, trained: Mapping[str, str]
) -> HaarCascade:
    """Return a cascade with the numbers that its file will have.

    Args:
        stages: as trained.
        diameter: m, of the object.
        trained: from what, for the reader.
    """
    return HaarCascade.model_validate(
        {
            "haar_cascade": 1,
            "side": SIDE,
            "width": INNER,
            "diameter": diameter,
            "stages": [_stage(it) for it in stages],
            "trained": dict(trained),
        }
    )


def _stage(trained: TrainedStage) -> dict[str, object]:
    stumps = []
    for stump, rectangles, weights in zip(trained.stage.stumps, *trained.features, strict=True):
        parts = [
            (*rectangle, weight)
            for rectangle, weight in zip(rectangles.tolist(), weights.tolist(), strict=True)
            if weight
        ]
        numbers = {"threshold": stump.threshold, "low": stump.low, "high": stump.high}
        stumps.append({**{key: _short(it) for key, it in numbers.items()}, "parts": parts})
    return {"limit": _short(trained.stage.limit), "stumps": stumps}


def _short(number: float) -> float:
    return float(f"{number:.{DIGITS}g}")


def text_of(cascade: HaarCascade, score: ScoreLaw) -> str:
    """Return a cascade as the text of its file.

    Args:
        cascade: to be written.
        score: the law of its scores.
    """
    data = cascade.model_copy(update={"score": score}).model_dump()
    stages = data.pop("stages")
    lines = [f"  {json.dumps(key)}: {json.dumps(value)}," for key, value in data.items()]
    blocks = (
        f'    {{"limit": {json.dumps(stage["limit"])}, "stumps": [\n      '
        + ",\n      ".join(map(json.dumps, stage["stumps"]))
        + "]}"
        for stage in stages
    )
    return "{\n" + "\n".join(lines) + '\n  "stages": [\n' + ",\n".join(blocks) + "\n  ]\n}\n"
