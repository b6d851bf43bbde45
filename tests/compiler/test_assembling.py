"""One topology: whatever the age, everything in the model has the same name in the same place."""

import mujoco
import numpy as np
import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.compiler.actuation import build_actuation
from mimoc.compiler.assembling import assemble_infant, place_senses
from mimoc.compiler.building import builder
from mimoc.compiler.looks.appearance import HEAD_FEATURES
from mimoc.fits import measure
from mimoc.schema import InfantSpec
from mimoc.schema.body import EXPRESSIONS

MITTEN = assemble("mitten", False)
SIZES = ("nbody", "njnt", "nq", "nv", "nu", "ngeom", "nsite", "ncam", "nsensor", "ntendon", "nkey", "nmat", "ntex")


def spec(**sections) -> InfantSpec:
    return InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9, **sections})


def names(model: mujoco.MjModel) -> bytes:
    """Return all names of a model, in order, but for the model's own."""
    return model.names.split(b"\0", 1)[1]


def test_names_and_their_order_are_the_same_at_every_age(infants):
    for infant in infants:
        assert names(infant.model) == names(infants[0].model), infant
        assert [getattr(infant.model, size) for size in SIZES] == [getattr(infants[0].model, size) for size in SIZES]


def test_the_tree_is_the_same_at_every_age(infants):
    for infant in infants:
        for links in ("body_parentid", "jnt_bodyid", "geom_bodyid", "geom_type", "geom_contype", "actuator_trnid"):
            assert np.array_equal(getattr(infant.model, links), getattr(infants[0].model, links)), links


def test_everything_in_the_model_has_a_name(infant_at):
    model = infant_at(9).model
    kinds = {"body": "nbody", "joint": "njnt", "geom": "ngeom", "site": "nsite", "camera": "ncam", "light": "nlight"}
    more = {"actuator": "nu", "sensor": "nsensor", "tendon": "ntendon", "key": "nkey", "mat": "nmat", "tex": "ntex"}
    for kind, count in (kinds | more).items():
        assert all(getattr(model, kind)(index).name for index in range(getattr(model, count))), kind


def test_features_of_the_head_only_show(infant_at):
    """Nose, ears and lids weigh nothing, touch nothing, and can be hidden as a group of their own."""
    model = infant_at(9).model
    shown = [model.geom(index).name for index in range(model.ngeom) if model.geom(index).group[0] == 1]
    assert shown == [feature.name for feature in HEAD_FEATURES]
    for name in shown:
        assert model.body(model.geom(name).bodyid[0]).name == "head"
        assert model.geom(name).contype[0] == model.geom(name).conaffinity[0] == 0


def test_features_grow_with_the_head(infants):
    for infant in infants:
        for feature in HEAD_FEATURES:
            size = infant.model.geom(feature.name).size[: len(feature.size)]
            radius_m = measure(infant.age_months)["head_circumference"] / (2 * np.pi)
            assert size == pytest.approx(np.array(feature.size) * radius_m, rel=1e-7)


def test_the_world_holds_the_infant_by_a_free_joint(infant_at):
    model = infant_at(9).model
    assert model.joint(0).name == "mimo_location"
    assert model.joint(0).type[0] == mujoco.mjtJoint.mjJNT_FREE


def test_the_infant_alone_stands_on_the_ground(infants):
    """As infant.xml has it: soles at z = 0, head up, facing +x."""
    for infant in infants:
        soles_m, _ = infant.span_m(np.array([0.0, 0.0, 1.0]), infant.geoms("left_foot", "right_toes"))
        assert soles_m == pytest.approx(0, abs=1e-8)
        assert infant.data.body("left_eye").xpos[0] > infant.data.body("head").xpos[0]
        assert infant.data.body("left_foot").xpos[1] > 0


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_the_expression_changes_the_face_and_nothing_else(expression):
    neutral, other = builder(spec()).infant, builder(spec(body={"expression": expression})).infant
    assert other.appearance.assets[f"assets/face_{expression}.png"]
    assert (neutral.roots, neutral.keyframes, neutral.actuators) == (other.roots, other.keyframes, other.actuators)


def test_composing_is_pure():
    tree = grow_tree(measure(9), MITTEN)
    drive, senses = build_actuation(spec().actuation, tree, timestep_s=0.005), place_senses(spec(), tree)
    first, second = (assemble_infant(spec(), tree, drive, senses) for _ in range(2))
    assert first == second
    assert tree == grow_tree(measure(9), MITTEN)
