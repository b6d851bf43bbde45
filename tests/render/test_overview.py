from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mimoc.compiler import building, loading
from mimoc.render import body_camera
from mimoc.render.body_camera import BodyCamera
from mimoc.render.camera import CLEARANCE_M, planes_of, shows
from mimoc.render.portrait import overview


@pytest.fixture(scope="module")
def playroom():
    """Return what builds the playroom of a seed."""
    return building.builder(loading.load_spec(Path(__file__).parents[2] / "configs" / "playroom.yaml"))


@pytest.fixture(scope="module")
def room(built):
    """Return an infant in a room with three toys."""
    return built(scene={"kind": "room", "pose": "sitting", "toys": {"count": [3, 3]}})


def test_toys_and_infant_are_in_the_picture(room, built):
    """It differs where they are from that of the same room without toys."""
    empty = built(scene={"kind": "room", "pose": "sitting"})
    full, bare = overview(room, 160, 120), overview(empty, 160, 120)
    assert full.shape == bare.shape == (120, 160, 3)
    assert not np.array_equal(full, bare)
    assert full.std() > 20


def test_the_same_room_is_the_same_picture(room):
    assert np.array_equal(overview(room, 80, 60), overview(room, 80, 60))


@pytest.mark.parametrize("seed", range(12))
def test_no_room_is_seen_through_a_wall(seed, playroom, monkeypatch):
    """Also seed 7, whose infant looks at a wall that is near; and everything is in the picture."""
    seen = []

    def look(camera, data):
        seen.append((camera.shot(data), camera.spheres(data), planes_of(data.model, data), camera.aspect))

    monkeypatch.setattr(BodyCamera, "render", look)
    monkeypatch.setattr(body_camera, "Renderer", lambda *_: SimpleNamespace(close=lambda: None))
    overview(playroom(seed, check=False), 32, 24)
    ((shot, spheres, walls, aspect),) = seen
    assert walls.clearance_m(shot.position_m) >= CLEARANCE_M
    assert shows(shot, spheres, aspect)
