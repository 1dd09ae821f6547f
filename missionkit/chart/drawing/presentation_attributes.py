"""A picture without a style sheet: its rules written as attributes of the shapes.

A page that forbids inline styles shows such a picture, and its own style sheet still wins.
"""

from __future__ import annotations

import re
from typing import NamedTuple
from xml.etree import ElementTree as ET  # parsed below is what this package has drawn itself

from defusedxml.ElementTree import fromstring

from missionkit.chart.drawing.svg_shapes import STYLE_SHEET

SVG = "http://www.w3.org/2000/svg"
RULE = re.compile(r"(?P<tag>\w*)(?P<classes>[.\w]*)\{(?P<values>[^}]*)\}")


class StyleRule(NamedTuple):
    """Attributes of the shapes that have a tag and all of some classes."""

    tag: str  # "": any
    classes: frozenset[str]
    values: tuple[tuple[str, str], ...]

    def fits(self, shape: ET.Element) -> bool:
        """Say whether a shape is meant."""
        named = not self.tag or shape.tag == f"{{{SVG}}}{self.tag}"
        return named and self.classes <= set(shape.get("class", "").split())


def _rule(text: str) -> StyleRule:
    match = RULE.fullmatch(text)
    assert match is not None, text  # noqa: S101 - the style sheet is this package's
    pairs = (pair.partition(":") for pair in match["values"].split(";") if pair)
    classes = frozenset(filter(None, match["classes"].split(".")))
    return StyleRule(match["tag"], classes, tuple((name, value) for name, _, value in pairs))


# the most general first: what comes later wins, as in a style sheet
RULES = sorted(map(_rule, STYLE_SHEET), key=lambda rule: (len(rule.classes), bool(rule.tag)))


def with_attributes(picture: str) -> str:
    """Return an SVG document of `svg_chart` whose looks are attributes, not a style sheet."""
    root: ET.Element = fromstring(picture)
    for sheet in root.findall(f"{{{SVG}}}style"):
        root.remove(sheet)
    for shape in root.iter():
        for rule in RULES:
            if rule.fits(shape):
                shape.attrib.update(rule.values)
    ET.register_namespace("", SVG)
    return ET.tostring(root, encoding="unicode")
