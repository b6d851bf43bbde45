"""A running infant, served to one browser on this machine."""

import re
from http.client import HTTPConnection, HTTPResponse
from urllib.parse import urlsplit

import pytest
import viser
import websockets.asyncio.server
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

import mimoc
from mimoc.base.errors import MimocError
from mimoc.viewer.live import Access, LiveView


@pytest.fixture(scope="module")
def env(bundle_at):
    env = mimoc.make(bundle_at(9)).unwrapped
    env.reset(seed=0)
    return env


@pytest.fixture
def live(env):
    with LiveView(env) as live:
        yield live


def get(live, path: str, **headers: str) -> HTTPResponse:
    """Ask for a page as a browser does, or as one that is led to this machine by another name."""
    connection = HTTPConnection("localhost", urlsplit(live.address).port)
    connection.putrequest("GET", path, skip_host="Host" in headers)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    response = connection.getresponse()
    response.text = response.read().decode()
    connection.close()
    return response


def path_of(live) -> str:
    return live.address.partition(str(urlsplit(live.address).port))[2]


def cookie_of(live) -> str:
    return get(live, path_of(live)).getheader("Set-Cookie").partition(";")[0]


def test_the_browser_that_opens_the_address_gets_the_page(live):
    opened = get(live, path_of(live))
    assert (opened.status, opened.getheader("Location")) == (303, "/")
    cookie, *attributes = opened.getheader("Set-Cookie").split("; ")
    assert attributes == ["Path=/", "HttpOnly", "SameSite=Strict"]
    page = get(live, "/", Cookie=f"other=1; {cookie}")
    assert page.status == 200
    assert "<html" in page.text


def test_the_address_works_once(live):
    path = path_of(live)
    assert [get(live, path).status for _ in range(2)] == [303, 403]


@pytest.mark.parametrize(
    "path", ["/", "/?token=", "/?token=None", "/?token=wrong", "/index.html", "//[", "/?%ff=&token"]
)
def test_without_token_or_cookie_nothing_is_served(path, live):
    refused = get(live, path)
    assert refused.status == 403
    assert refused.text == (
        "This page is only for the browser that opened the address which mimoc printed; the address works once.\n"
    )


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "rebound.example:8080"},
        {"Host": "localhost.example"},
        {"Host": "localhost, localhost"},
        {"Host": "["},
        {"Origin": "https://elsewhere.example"},
        {"Origin": "http://localhost:1"},
        {"Origin": "null"},
    ],
    ids=str,
)
def test_a_page_from_elsewhere_gets_nothing_even_with_the_cookie(headers, live):
    cookie = cookie_of(live)
    assert get(live, "/", Cookie=cookie).status == 200
    assert get(live, "/", Cookie=cookie, **headers).status == 403


def test_only_the_page_itself_reaches_the_simulation(live):
    """As a page from elsewhere could have paused it: its browser sends our cookie, but says where the page is from."""
    cookie, host = cookie_of(live), urlsplit(live.address).netloc
    versions = {"subprotocols": [f"viser-v{viser.__version__}"]}
    with connect(f"ws://{host}", origin=f"http://{host}", additional_headers={"Cookie": cookie}, **versions) as page:
        assert page.recv(timeout=10)
    for origin, headers in ((f"http://{host}", {}), ("http://elsewhere.example", {"Cookie": cookie})):
        with (
            pytest.raises(InvalidStatus, match="HTTP 403"),
            connect(f"ws://{host}", origin=origin, additional_headers=headers, **versions),
        ):
            pass


def test_a_viser_that_would_not_ask_is_stopped(monkeypatch):
    class Unguarded:
        stopped = False

        def stop(self):
            self.stopped = True

    server = Unguarded()
    before = websockets.asyncio.server.serve
    with pytest.raises(MimocError, match="serves in a way that mimoc cannot guard"):
        Access().serve(lambda: server)
    assert server.stopped
    assert websockets.asyncio.server.serve is before


def test_it_shows_where_the_infant_is_and_prints_nothing_besides(env, capsys):
    with LiveView(env) as live:
        assert re.fullmatch(r"http://localhost:\d+/\?token=[\w-]{22}", live.address)
        for _ in range(4):  # A picture is sent every 40 ms.
            env.step(env.action_space.sample())
            live.show()
        frames = {body: tuple(frame.position) for body, frame in live._bodies.items()}
        assert frames == {body: pytest.approx(env.data.xpos[body]) for body in frames}
        assert len(frames) >= 2  # The eyes.
    assert capsys.readouterr().out == ""
