"""What the commands of the page refuse, in a sentence."""

import pytest
from documents import ROOT

MISSION = str(ROOT / "missions" / "survey.yaml")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("page", "nowhere"), "nowhere"),
        (("play", "nowhere.yaml"), "nowhere.yaml"),
        (("play", MISSION, "--bind", "192.0.2.1:8123"), "serve it over TLS"),
        (("play", MISSION, "--tls-key", MISSION), "belong together"),
        (
            ("play", MISSION, "--bind", "127.0.0.1:0", "--tiles", MISSION),
            "expected a file of tiles",
        ),
        (("run", MISSION, "--bind", "9000"), "add --page"),
        (("run", MISSION, "--tiles", MISSION), "--tiles is about the page: add --page"),
        (("run", MISSION, "--page", "--bind", "[::]:9000"), "name the address of this computer"),
    ],
)
def test_it_is_refused_with_a_sentence(call, arguments, says):
    done = call(*arguments)
    assert done.exit_code == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr
