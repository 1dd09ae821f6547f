"""Who may not come in does not: by name, by origin, by token, by session key."""

import pytest
from browsing import Browser, port_of, served
from websockets.exceptions import InvalidStatus

from missionkit.errors import UsageError
from missionkit.page.recording.recording_source import RecordingSource
from missionkit.page.server.binding import binding
from missionkit.page.server.origin_check import Addresses
from missionkit.page.server.sessions import Tokens


@pytest.fixture
def guarded(recorded):
    tokens = Tokens.fresh()
    with served(RecordingSource(recorded), tokens) as address:
        yield Browser(port_of(address)), tokens


def test_another_name_is_not_served(browser):
    for host in ("evil.example", f"evil.example:{browser.port}", "127.0.0.1"):
        status, headers, _ = browser.request("GET", "/api/mission", Host=host)
        assert status in {400, 403}, host
        assert "access-control-allow-origin" not in headers


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", ""])
def test_another_site_cannot_post_or_listen(browser, origin):
    status, said = browser.post("/api/action", {"action": "land"}, Origin=origin)
    assert status == 403
    assert "this server" in said["error"]
    with pytest.raises(InvalidStatus), browser.live(Origin=origin or "file://"):
        pass


def test_without_a_token_there_is_nothing(guarded):
    browser, tokens = guarded
    assert browser.enter() == browser.enter("guess") == browser.enter(tokens.view[:-1]) == 401
    for path in ("/api/mission", "/api/timeline", "/api/chart.svg", "/api/image.jpg?n=0"):
        assert browser.request("GET", path)[0] == 401
    assert browser.post("/api/action", {"action": "land"})[0] == 401
    with pytest.raises(InvalidStatus), browser.live():
        pass
    assert browser.request("GET", "/")[0] == 200


def test_a_token_opens_a_session_that_a_reload_finds_again(guarded):
    browser, tokens = guarded
    assert (browser.enter(tokens.pilot), browser.role) == (200, "pilot")
    before = browser.cookie, browser.csrf
    assert browser.enter() == 200
    assert (browser.cookie, browser.csrf) == before
    status, headers, _ = browser.request("POST", "/api/session", {"token": tokens.view})
    assert status == 200
    assert {"HttpOnly", "SameSite=strict"} <= {
        part.strip() for part in headers["set-cookie"].split(";")
    }


def test_a_viewer_looks_and_does_nothing(guarded):
    browser, tokens = guarded
    assert (browser.enter(tokens.view), browser.role) == (200, "viewer")
    assert browser.get("/api/mission")["title"] == "hop"
    status, said = browser.post("/api/action", {"action": "land"})
    assert status == 403
    assert "viewer" in said["error"]


def test_a_request_without_the_session_key_is_refused(browser):
    for key in ("", "wrong"):
        status, said = browser.post("/api/action", {"action": "land"}, X_CSRF=key)
        assert (status, "key" in said["error"]) == (403, True)


def test_every_answer_forbids_what_the_page_does_not_need(browser):
    for path in ("/", "/api/mission", "/api/nothing", "/web/nothing"):
        _, headers, _ = browser.request("GET", path)
        assert headers["content-security-policy"].startswith("default-src 'self'; ")
        assert headers["x-content-type-options"] == "nosniff"
        assert path == "/" or "api" not in path or headers["cache-control"] == "no-store"


@pytest.mark.parametrize(
    "path",
    ["/web/../pyproject.toml", "/web/%2e%2e/%2e%2e/pyproject.toml", "/web//etc/passwd", "/web/"],
)
def test_a_file_name_comes_from_the_package_alone(browser, path):
    assert browser.request("GET", path)[0] == 404


def test_a_request_that_is_no_json_or_too_long_gets_a_sentence(browser):
    assert browser.post("/api/action", ["land"])[1] == {
        "error": "the request must be a JSON object"
    }
    assert browser.post("/api/action", {"x": "y" * 70_000})[0] == 413


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("192.168.1.20:8123", "over TLS"),
        ("127.example:8123", "over TLS"),
        ("0.0.0.0:8123", "name the address of this computer"),
        ("127.0.0.1:99999", "expected HOST:PORT"),
        ("localhost:http", "expected HOST:PORT"),
    ],
)
def test_where_others_could_listen_it_is_not_served(text, says):
    with pytest.raises(UsageError, match=says):
        binding(text)


def test_where_it_is_served(tmp_path):
    assert binding("[::1]:90")[:2] == ("::1", 90)
    assert binding("9000")[:2] == ("127.0.0.1", 9000)
    assert binding("localhost")[:2] == ("localhost", 8123)
    certificate = tmp_path / "cert.pem"
    certificate.touch()
    assert binding("ship.example:443", certificate, certificate).secure
    with pytest.raises(UsageError, match="belong together"):
        binding("ship.example:443", certificate)
    hosts = Addresses.of("ship.example", 443, secure=True).hosts
    assert hosts == {"ship.example", "ship.example:443"}
