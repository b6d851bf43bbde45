from pathlib import Path

import numpy as np
import pytest

from mimoc.compiler import building, loading
from mimoc.render.camera import OFF_THE_WALL_M, shows, walls_of
from mimoc.render.overview import overview
from mimoc.render.portrait import Painter


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

    def look(painter, data):
        seen.append((painter.shot(data), painter.balls(data), walls_of(data.model, data), painter.aspect))

    monkeypatch.setattr(Painter, "paint", look)
    overview(playroom(seed, check=False), 32, 24)
    ((shot, balls, walls, aspect),) = seen
    assert walls.before_m(shot.place_m) >= OFF_THE_WALL_M
    assert shows(shot, balls, aspect)
