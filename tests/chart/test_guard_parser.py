from __future__ import annotations

import pytest
from pydantic import ValidationError

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.guard_parser import parse
from missionkit.chart.model.model_base import Scope
from missionkit.chart.model.named_guards import problems_of
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.text.yaml_reader import read
from missionkit.errors import Place
from missionkit.guards.converged import Converged
from missionkit.guards.distances import Within
from missionkit.guards.state_progress import Done


@pytest.fixture
def scope(catalogue: Catalogue) -> Scope:
    return Scope(catalogue, frozenset(), frozenset({"trunk"}), frozenset({"sure", "near"}))


def parsed(text: str, scope: Scope) -> ex.Expression:
    return parse(read(f"when: {text}\n", "m.yaml").data["when"], scope)


def test_every_form_becomes_data_with_its_place(scope: Scope):
    found = parsed("{all: [sure, {not: {any: [near, converged]}}]}", scope)
    assert found == ex.All(
        (
            ex.Named("sure", Place("m.yaml", 1, 14)),
            ex.Not(
                ex.Any(
                    (
                        ex.Named("near", Place("m.yaml", 1, 33)),
                        ex.Use("converged", Converged(), Place("m.yaml", 1, 39)),
                    ),
                    Place("m.yaml", 1, 26),
                ),
                Place("m.yaml", 1, 20),
            ),
        ),
        Place("m.yaml", 1, 7),
    )


def test_hysteresis_holds_one_guard(scope: Scope):
    text = "{hysteresis: {use: within, of: trunk, radius: 8}, enter: 8, exit: 9.5}"
    within = ex.Use("within", Within(of="trunk", radius=8), Place("m.yaml", 1, 20))
    assert parsed(text, scope) == ex.Hysteresis(within, 8.0, 9.5, Place("m.yaml", 1, 7))


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("{all: [sure, near]}", "sure and near"),
        ("{not: converged}", "not converged"),
        (
            "{all: [sure, {any: [near, {not: {all: [sure, near]}}]}]}",
            "sure and (near or not (sure and near))",
        ),
        ("{use: within, of: trunk, radius: 8}", "within (of trunk, radius 8)"),
        ("{hysteresis: near, enter: 0.7, exit: 0.5}", "near from 0.7 until 0.5"),
    ],
)
def test_text(written: str, said: str, scope: Scope):
    assert ex.text(parsed(written, scope)) == said


@pytest.mark.parametrize(
    ("written", "path", "message"),
    [
        ("{all: []}", ("all",), "'all': expected a list of guards, got a list"),
        ("{}", (), "expected one of use, all, any, not, hysteresis, variable, in, got nothing"),
        ("[sure]", (), "expected a guard, got a list"),
        ("{not: 3}", ("not",), "expected a guard, got 3"),
        ("within", (), "guard 'within' needs parameters: {use: within, ...}"),
        ("{use: [a]}", ("use",), "unknown guard a list"),
        ("{not: sure, for: 2}", ("for",), "unknown key 'for' beside 'not'"),
        (
            "{hysteresis: {not: sure}, enter: 1, exit: 2}",
            ("hysteresis",),
            "expected one guard with a value, not a combination",
        ),
        ("{hysteresis: sure, enter: 1, exit: 1}", ("exit",), "'enter' and 'exit' must differ"),
        ("{hysteresis: sure, enter: 1}", ("exit",), "missing key 'exit': a number"),
    ],
)
def test_mistakes_have_their_path(written: str, path: tuple[str, ...], message: str, scope: Scope):
    with pytest.raises(ValidationError) as error:
        parsed(written, scope)
    (only,) = error.value.errors()
    assert only["loc"] == path
    assert only["msg"].startswith(message)


def test_all_mistakes_are_reported_at_once(scope: Scope):
    with pytest.raises(ValidationError) as error:
        parsed("{all: [x, {any: [sure, {use: within}]}, {not: y}]}", scope)
    assert [item["loc"] for item in error.value.errors()] == [
        ("all", 0),
        ("all", 1, "any", 1, "of"),
        ("all", 1, "any", 1, "radius"),
        ("all", 2, "not"),
    ]


def named(**guards: str) -> dict[str, ex.Expression]:
    return {
        name: ex.All(tuple(ex.Named(need, Place(name, 1, 1)) for need in needs), Place(name, 1, 1))
        for name, needs in guards.items()
    }


def test_circles_are_found():
    found = [str(problem) for problem in problems_of(named(a="bd", b="a", c="a", d="d"))]
    assert sorted(found) == [
        "a:1:1: guard 'a' refers to itself: a -> b -> a",
        "d:1:1: guard 'd' refers to itself: d -> d",
    ]


def test_a_long_chain_is_refused():
    at = Place("m.yaml", 1, 1)
    chain: dict[str, ex.Expression] = {f"g{n}": ex.Named(f"g{n + 1}", at) for n in range(3000)}
    chain["g3000"] = ex.Use("done", Done(), at)
    (problem,) = problems_of(chain)
    assert problem.message == "guard 'g2936' is defined through more than 64 others"
