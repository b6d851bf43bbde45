"""A page that shows an environment while it runs, served to the one browser on this machine that opened its address."""

import io
import re
import secrets
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, redirect_stdout
from http import HTTPStatus
from importlib import import_module
from typing import Any
from urllib.parse import parse_qs

import mujoco
import numpy as np

from mimoc.base.errors import MimocError, MissingExtraError
from mimoc.base.mujoco_layout import LAST_VISIBLE_GROUP
from mimoc.runtime.infant import Infant
from mimoc.viewer.appearance import colour_of, coloured_faces, mesh_of, skin_of, texture_of

HOST = "localhost"  # Where pages are served: others on the network see nothing.
LOCAL_HOST = re.compile(r"(localhost|127\.0\.0\.1|\[::1\])(:\d+)?")
"""What this machine calls itself. Other names may be a stranger's that were made to lead here (DNS rebinding)."""
TOKEN = "token"  # Key of the token in the address.
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
        self._token = secrets.token_urlsafe(16)
        self._is_token_used = False
        self._cookie = secrets.token_urlsafe(16)

    def address(self, port: int) -> str:
        """Return the address to open in a browser, which works once."""
        return f"http://{HOST}:{port}/?{TOKEN}={self._token}"

    def guard(self, process_request: ProcessRequest) -> ProcessRequest:
        """Return what processes only the requests that may be answered, and refuses all others."""

        def process(connection: Any, request: Any) -> Any:
            # Both values of a header that is sent twice count, and so it is not what is expected.
            host, origin, cookies = (", ".join(request.headers.get_all(name)) for name in ("Host", "Origin", "Cookie"))
            if LOCAL_HOST.fullmatch(host) and origin in ("", f"http://{host}"):
                if self._has_cookie(host, cookies):
                    return process_request(connection, request)
                if self._use_token(request.path):
                    response = connection.respond(HTTPStatus.SEE_OTHER, "")
                    response.headers["Location"] = "/"
                    response.headers["Set-Cookie"] = (
                        f"{_cookie_name(host)}={self._cookie}; Path=/; HttpOnly; SameSite=Strict"
                    )
                    return response
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


def _cookie_name(host: str) -> str:
    return f"mimoc-{host.rpartition(':')[2]}"


PORT = 8080
CAMERA_M = (0.9, 0.6, 0.5)  # Where browsers look from at first, relative to the infant.
PICTURE_S = 0.04  # Simulated time between what browsers are sent; moving a skin takes some milliseconds.
PAUSE_S = 0.02  # How often a paused page looks whether it goes on.
COLOURS = 6  # Most colours of the picture on a skin: faces of each are a mesh of their own.


class LiveView(AbstractContextManager["LiveView"]):
    """Serves what an environment does, in real time, to the browser that opens its address first.

    with LiveView(env) as live:
        print(live.address)
        for _ in range(1000):
            env.step(env.action_space.sample())
            live.show()
    """

    def __init__(self, env: Infant, port: int = PORT):
        """Serve the environment of an infant, which has been reset, at a port of this machine.

        If the port is taken, it is the next free one.

        Raises:
            MissingExtraError: If viser is not installed.
            MimocError: If no port is free.
        """
        self._env, self._access = env, Access()
        self._server: Any = _serve(port, env.manifest.name, self._access)
        self._server.gui.configure_theme(show_share_button=False)  # It would ask a server elsewhere.
        self._bodies = self._add_bodies(env.model)
        self._skins = self._add_skins(env.model)
        self._pause = self._server.gui.add_checkbox("Pause", initial_value=False)
        self._clock = self._server.gui.add_markdown("")
        root = env.data.body(env.manifest.root_body).xpos
        self._server.initial_camera.look_at = tuple(root)
        self._server.initial_camera.position = tuple(root + np.array(CAMERA_M))
        self._start_s, self._shown_s = self._ahead_s(), -PICTURE_S
        self.show()

    @property
    def address(self) -> str:
        """Address to open in a browser, which works once: that browser can then load the page again, others cannot."""
        return self._access.address(self._server.get_port())

    def show(self) -> None:
        """Show the environment as it is now, when its time has come; wait while the page is paused."""
        while self._pause.value:
            time.sleep(PAUSE_S)
            self._start_s = self._ahead_s()
        early_s = self._ahead_s() - self._start_s
        if early_s < 0:  # Slower than real time, or reset: count from now on.
            self._start_s += early_s
        time.sleep(max(early_s, 0.0))
        if 0 <= self._env.data.time - self._shown_s < PICTURE_S - 1e-6:
            return
        self._shown_s = self._env.data.time
        data = self._env.data
        with self._server.atomic():
            for body, frame in self._bodies.items():
                frame.position, frame.wxyz = data.xpos[body], data.xquat[body]
            for mesh, bodies in self._skins:
                for bone, body in zip(mesh.bones, bodies, strict=True):
                    bone.position, bone.wxyz = data.xpos[body], data.xquat[body]
        self._clock.content = f"{data.time:.1f} s"

    def close(self) -> None:
        """Stop serving; closing twice is fine."""
        with _without_messages():
            self._server.stop()

    def __exit__(self, *_: object) -> None:
        self.close()

    def _add_bodies(self, model: mujoco.MjModel) -> dict[int, Any]:
        scene = self._server.scene
        scene.set_up_direction("+z")
        frames: dict[int, Any] = {}
        for geom in np.flatnonzero(model.geom_group <= LAST_VISIBLE_GROUP).tolist():
            if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
                scene.add_grid(f"/{model.geom(geom).name}", width=4, height=4, cell_size=0.1)
                continue
            body = int(model.geom_bodyid[geom])
            name = f"/{model.body(body).name}"
            if body not in frames:
                frames[body] = scene.add_frame(name, show_axes=False)
            vertices_m, faces = mesh_of(model, geom)
            material = model.geom_matid[geom]
            pixels = texture_of(model, material)
            rgba = model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]
            scene.add_mesh_simple(
                f"{name}/{model.geom(geom).name}",
                vertices_m,
                faces,
                color=colour_of(rgba[:3] * (255 if pixels is None else pixels.mean(axis=(0, 1)))),
                position=model.geom_pos[geom],
                wxyz=model.geom_quat[geom],
            )
        return frames

    def _add_skins(self, model: mujoco.MjModel) -> list[tuple[Any, list[int]]]:
        skins = []
        for index in range(model.nskin):
            skin = skin_of(model, index)
            for colour, faces in coloured_faces(model, index, COLOURS):
                used, renumbered = np.unique(faces, return_inverse=True)
                movers = np.flatnonzero(skin.weights[used].any(axis=0))
                mesh = self._server.scene.add_mesh_skinned(
                    f"/skins/{model.skin(index).name}/{len(skins)}",
                    skin.vertices_m[used],
                    renumbered.reshape(-1, 3),
                    bone_wxyzs=skin.bind_quat[movers],
                    bone_positions=skin.bind_pos[movers],
                    skin_weights=skin.weights[np.ix_(used, movers)],
                    color=colour,
                    side="double",
                )
                skins.append((mesh, skin.bodies[movers].tolist()))
        return skins

    def _ahead_s(self) -> float:
        """Return how far the simulation's clock is ahead of the wall's, but for a constant."""
        return self._env.data.time - time.monotonic()


def _serve(port: int, name: str, access: Access) -> Any:
    try:
        import viser
    except ImportError:
        raise MissingExtraError("viser", "live") from None
    try:
        with _without_messages():
            return access.serve(lambda: viser.ViserServer(host=HOST, port=port, label=name, verbose=False))
    except OSError as error:
        raise MimocError(
            f"port {port} cannot be used ({error.strerror or error}); choose another with --port"
        ) from None


def _without_messages() -> AbstractContextManager[Any]:
    """Keep viser from printing its own address, which opens nothing, and that it has stopped."""
    return redirect_stdout(io.StringIO())
