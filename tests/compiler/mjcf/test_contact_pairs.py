"""Walls are touched by listed pairs: as if their contact bits let them, without MuJoCo's tree of boxes."""

import mujoco
import numpy as np
import pytest
from lxml import etree

from mimoc.compiler import model_check, pipeline
from mimoc.schema import InfantSpec

FELT = ("dim", "friction", "solref", "solimp", "includemargin")


@pytest.fixture(scope="module", params=["mitten", "five_finger"])
def room(request) -> dict[str, bytes]:
    data = {
        "mimoc": 1,
        "name": "x",
        "age_months": 9,
        "body": {"hands": request.param},
        "scene": {"kind": "room", "toys": {"count": [4, 4]}},
    }
    return dict(pipeline.build(InfantSpec.model_validate(data)).files)


def with_solid_walls(files: dict[str, bytes]) -> mujoco.MjModel:
    """Return the room with walls and ceiling that touch by their contact bits, and no listed pairs of theirs."""
    tree = etree.fromstring(files["scene.xml"])
    pairs = tree.findall("contact/pair")
    for name in {pair.get("geom1") for pair in pairs}:
        (wall,) = tree.xpath(f"worldbody/geom[@name='{name}']")
        wall.set("contype", "1")
        wall.set("conaffinity", "1")
    for pair in pairs:
        pair.getparent().remove(pair)
    return model_check.compile_model({**files, "scene.xml": etree.tostring(tree)})


def contacts(model: mujoco.MjModel, data: mujoco.MjData) -> dict[tuple, list[np.ndarray]]:
    """Return what each contact is like, by its geoms and its place."""
    mujoco.mj_forward(model, data)
    return {
        (*sorted(contact.geom.tolist()), *np.round(contact.pos, 9), round(contact.dist, 9)): [
            np.copy(getattr(contact, name)) for name in FELT
        ]
        for contact in data.contact
    }


def test_walls_and_ceiling_are_touched_as_by_contact_bits(room):
    paired, solid = model_check.compile_model(room), with_solid_walls(room)
    assert (paired.npair, solid.npair) == (5 * _touching(solid), 0)
    wall_touched, generator = 0, np.random.default_rng(0)
    depth, width, height = _half_size_m(paired)
    for _ in range(40):
        states = mujoco.MjData(paired), mujoco.MjData(solid)
        states[0].qpos[:3] = generator.uniform([-depth, -width, 0], [depth, width, 2 * height])
        states[0].qpos[3:7] = generator.normal(size=4)
        states[1].qpos[:] = states[0].qpos
        by_pair, by_bits = contacts(paired, states[0]), contacts(solid, states[1])
        assert by_pair.keys() == by_bits.keys()
        for where, felt in by_pair.items():
            for mine, theirs in zip(felt, by_bits[where], strict=True):
                np.testing.assert_allclose(mine, theirs, atol=1e-12, err_msg=str(where))
        wall_touched += bool(np.isin(states[0].contact.geom, _walls(paired)).any())
    assert wall_touched > 5


def test_rooms_ask_for_nothing_that_warp_lacks(room):
    assert b"midphase" not in room["scene.xml"] + room["infant.xml"]
    assert model_check.compile_model(room).opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE) == 0


def _touching(model: mujoco.MjModel) -> int:
    """Return how many geoms of what moves touch anything."""
    moves = model.body_weldid[model.geom_bodyid] != 0
    return int(((model.geom_contype | model.geom_conaffinity).astype(bool) & moves).sum())


def _half_size_m(model: mujoco.MjModel) -> np.ndarray:
    return np.array([*model.geom("floor").size[:2], model.geom("ceiling").pos[2] / 2])


def _walls(model: mujoco.MjModel) -> list[int]:
    return [model.geom(name).id for name in ("wall_front", "wall_back", "wall_left", "wall_right", "ceiling")]
