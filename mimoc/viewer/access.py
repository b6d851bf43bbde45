"""Access to a served page: for the one browser that opened the address, and from that page alone."""

import re
import secrets
from collections.abc import Callable
from http import HTTPStatus
from importlib import import_module
from typing import Any
from urllib.parse import parse_qs

from mimoc.errors import MimocError

HOST = "localhost"
"""Where pages are served: others on the network see nothing."""
LOCAL_HOST = re.compile(r"(localhost|127\.0\.0\.1|\[::1\])(:\d+)?")
"""What this machine calls itself. Other names may be a stranger's that were made to lead here (DNS rebinding)."""
TOKEN = "token"
"""Key of the token in the address."""
REFUSAL = "This page is only for the browser that opened the address which mimoc printed; the address works once.\n"

ProcessRequest = Callable[[Any, Any], Any]
"""What the library `websockets` asks for each request: from connection and request to a response; None to go on."""


class Access:
    """Decides which requests a server on this machine answers.

    A request has to name this machine as its host. A page that makes it has to come from the same server: what another
    page, from elsewhere or from another port, asks for is refused. And it has to prove that it comes from whoever reads
    what mimoc prints: by the token in the address, which is exchanged for a cookie when it is first used, or by that
    cookie.
    """

    def __init__(self) -> None:
        """Make a token and a cookie that nobody can guess."""
        self._token, self._is_token_used = secrets.token_urlsafe(16), False
        self._cookie = secrets.token_urlsafe(16)

    def address(self, port: int) -> str:
        """Return the address to open in a browser, which works once."""
        return f"http://{HOST}:{port}/?{TOKEN}={self._token}"

    def guard(self, process_request: ProcessRequest) -> ProcessRequest:
        """Return what processes only the requests that may be answered, and refuses all others."""

        def process(connection: Any, request: Any) -> Any:
            # Of a header that is sent twice, both values count, and so it is not what is expected.
            host, origin, cookies = (", ".join(request.headers.get_all(name)) for name in ("Host", "Origin", "Cookie"))
            if _is_local(host) and origin in ("", f"http://{host}"):
                if self._has_cookie(host, cookies):
                    return process_request(connection, request)
                if self._use_token(request.path):
                    return self._hand_out_cookie(connection, host)
            return connection.respond(HTTPStatus.FORBIDDEN, REFUSAL)

        return process

    def serve(self, start: Callable[[], Any]) -> Any:
        """Return what *start* returns, which starts a server of the library `websockets`, with its requests guarded.

        Viser has no option for that, so what makes its server is wrapped while it starts.

        Raises:
            MimocError: If the server that was started is not guarded.
        """
        module: Any = import_module("websockets.asyncio.server")
        guarded: list[bool] = []

        def guarded_serve(*arguments: Any, process_request: ProcessRequest, **options: Any) -> Any:
            guarded.append(True)
            return original(*arguments, process_request=self.guard(process_request), **options)

        original, module.serve = module.serve, guarded_serve
        try:
            server = start()
        finally:
            module.serve = original
        if not guarded:
            server.stop()
            raise MimocError("this version of viser serves in a way that mimoc cannot guard; install viser 1.1")
        return server

    def _has_cookie(self, host: str, header: str) -> bool:
        pairs = (part.strip().partition("=") for part in header.split(";"))
        cookies = {name: value for name, _, value in pairs}
        return secrets.compare_digest(cookies.get(_cookie_name(host), "").encode(), self._cookie.encode())

    def _use_token(self, path: str) -> bool:
        """Return whether a path has the token, which then cannot be used again."""
        (token, *_) = parse_qs(path.partition("?")[2]).get(TOKEN, [""])
        if self._is_token_used or not secrets.compare_digest(token.encode(), self._token.encode()):
            return False
        self._is_token_used = True
        return True

    def _hand_out_cookie(self, connection: Any, host: str) -> Any:
        """Return the response that gives a browser the cookie and leads it to the page."""
        response = connection.respond(HTTPStatus.SEE_OTHER, "")
        response.headers["Location"] = "/"
        response.headers["Set-Cookie"] = f"{_cookie_name(host)}={self._cookie}; Path=/; HttpOnly; SameSite=Strict"
        return response


def _is_local(host: str) -> bool:
    """Return whether a host, such as `localhost:8080`, is this machine."""
    return LOCAL_HOST.fullmatch(host) is not None


def _cookie_name(host: str) -> str:
    """Return the name of the cookie: browsers share cookies among all ports of a machine."""
    return f"mimoc-{host.rpartition(':')[2]}"
