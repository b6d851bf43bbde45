"""A prefix changes the names of an infant and nothing else."""

import mujoco
import numpy as np
import pytest
from lxml import etree

import mimoc
from mimoc.compiler.building import builder
from mimoc.compiler.mjcf import printing
from mimoc.compiler.mjcf.printing import prefixed_scene

INFANTS = {
    "mitten": {},
    "five fingers": {"body": {"hands": "five_finger"}},
    "muscles": {"actuation": {"model": "muscle"}},
    "spastic": {"impairments": {"preset": "diplegia"}},
    "published": {"development": "published"},
}
REFERRING = ("name", "joint", "site", "body1", "body2", "geom1", "geom2", "material", "texture", "class", "childclass")


@pytest.mark.parametrize("kind", INFANTS)
def test_all_names_begin_with_the_prefix_and_all_numbers_stay(kind):
    data = {"mimoc": 1, "name": "kim", "age_months": 9, "senses": {"touch": {}}, **INFANTS[kind]}
    plain = builder(mimoc.InfantSpec.model_validate(data)).infant
    ours, theirs = (
        etree.fromstring(printing.render_inhabitant(scene)) for scene in (plain, prefixed_scene(plain, "a_"))
    )
    for one, other in zip(ours.iter(), theirs.iter(), strict=True):
        assert one.tag == other.tag
        for key, value in one.attrib.items():
            if key == "name" and one.tag in ("exclude", "pair"):
                first, _, second = value.partition("-")
                assert other.get(key) == f"a_{first}-a_{second}"
            elif key in REFERRING:
                assert other.get(key) == f"a_{value}"
            elif one.tag == "skin" and key == "file":
                assert other.get(key) == value.replace("assets/", "assets/a_")
            else:
                assert other.get(key) == value


def test_a_skin_is_moved_by_the_bodies_with_the_prefix():
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "kim", "age_months": 9, "senses": {}})
    bundle = mimoc.build_world({"a": spec, "b": spec})
    model = mujoco.MjModel.from_xml_string(
        bundle.files["scene.xml"].decode(), {name: bundle.files[name] for name in bundle.files if "assets/" in name}
    )
    for skin in range(model.nskin):
        prefix = model.skin(skin).name[:2]
        bones = model.skin_bonebodyid[model.skin_boneadr[skin] :][: model.skin_bonenum[skin]]
        assert all(model.body(body).name.startswith(prefix) for body in bones)
    halves = np.split(model.skin_vert, 2)
    assert np.array_equal(*halves)
