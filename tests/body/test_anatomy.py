"""At 18 months, what does not grow is MIMo's published bodies to the last digit, in the order MuJoCo compiles them."""

from itertools import combinations, product

import mujoco
import numpy as np
import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.base.geometry.primitives import volume
from mimoc.body.grow import grow_average

ACTUATORS = {("mitten", False): 44, ("mitten", True): 46, ("five_finger", False): 88, ("five_finger", True): 90}

SOLREF_LIMIT, SOLIMP_LIMIT = (0.02, 1), (0.98, 0.99, 0.001, 0.5, 1)
SOLREF, SOLIMP = (0.005, 1), (0.95, 0.99, 0.001, 0.5, 1)
FRICTION = "1 .005 .0002"
GEOM_TYPES = {
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "box": mujoco.mjtGeom.mjGEOM_BOX,
}


def floats(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def names(count: int, accessor) -> list[str]:
    return [accessor(index).name for index in range(count)]


def test_bodies_are_mimos(model, published):
    rows = published("bodies")
    assert names(model.nbody, model.body) == ["world", *(row["name"] for row in rows)]
    assert [model.body(model.body(row["name"]).parentid[0]).name for row in rows] == [row["parent"] for row in rows]


def test_joints_are_mimos(model, published):
    rows = published("joints")
    assert names(model.njnt, model.joint) == ["mimo_location", *(row["name"] for row in rows)]
    for row in rows:
        joint = model.joint(row["name"])
        axis = np.array(floats(row["axis"]))
        assert model.body(joint.bodyid[0]).name == row["body"]
        assert joint.type == mujoco.mjtJoint.mjJNT_HINGE
        assert joint.limited
        assert joint.axis == pytest.approx(axis / np.linalg.norm(axis)), row
        assert joint.range == pytest.approx(np.radians(floats(row["range_deg"]))), row
        assert joint.stiffness[0] == float(row["stiffness_nm_per_rad"])
        assert joint.damping[0] == float(row["damping_nms_per_rad"])
        assert joint.frictionloss == float(row["frictionloss_nm"] or 0)
        assert joint.armature == float(row["armature_kgm2"])
        assert joint.qpos_spring == pytest.approx(np.radians(float(row["springref_deg"])))
        assert joint.solref == pytest.approx(SOLREF_LIMIT)
        assert joint.solimp == pytest.approx(SOLIMP_LIMIT)


def test_geoms_are_mimos(model, published):
    rows = published("geoms")
    own = [name for name in names(model.ngeom, model.geom) if model.geom(name).group == 0 and name != "floor"]
    assert own == [row["name"] for row in rows]
    for row in rows:
        geom = model.geom(row["name"])
        assert model.body(geom.bodyid[0]).name == row["body"]
        assert geom.type == GEOM_TYPES[row["type"]]
        assert geom.friction == pytest.approx(floats(row["friction"] or FRICTION)), row
        assert geom.condim == int(row["condim"] or 3)
        assert geom.solref == pytest.approx(SOLREF)
        assert geom.solimp == pytest.approx(SOLIMP)
        assert model.mat(geom.matid[0]).name == (row["material"] or "skin")


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_parts_have_the_densities_of_mimos_reference_body(hands, reference):
    geoms = grow_average(18, assemble(hands, False, "published")).geoms
    rows = {row["name"]: row for row in reference("geoms", hands)}
    assert geoms.keys() == rows.keys()
    for name, geom in geoms.items():
        mimos_m3 = volume(geom.type, tuple(floats(rows[name]["size_m"])))
        density = float(rows[name]["mass_kg"]) / mimos_m3
        assert geom.mass_kg / volume(geom.type, geom.size_m) == pytest.approx(density), name


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_by_the_law_maturing_the_child_of_18_months_weighs_what_mimo_does(hands):
    mass_kg = grow_average(18, assemble(hands, False)).mass_kg
    assert mass_kg == pytest.approx(10.9, abs=0.05)


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
@pytest.mark.parametrize("age_months", [0, 1.5, 4.5, 9, 14, 24])
def test_no_part_is_of_cork_or_lead(age_months, hands):
    """Most have the density of flesh and bones; overlapping parts of the trunk, by which it can bend, differ more."""
    for development in ("published", "maturing"):
        for name, geom in grow_average(age_months, assemble(hands, True, development)).geoms.items():
            density = geom.mass_kg / volume(geom.type, geom.size_m)
            lowest, highest = (440, 1350) if name in TRUNK else (640, 1210)
            assert lowest < density < highest or geom.mass_kg == 0, name


TRUNK = {"lb", "cb", "ub1", "ub2", "ub3"}
FILLERS = {"neck"}
"""The neck fills a gap and collides with nothing; MIMo's own collided with what its bit masks were left at."""
OWN = {frozenset(("left_eye", "chest")), frozenset(("right_eye", "chest"))}
"""Exceptions that MIMo does not have: eyes pass through the chest as through the body it was split from."""
FOLDING = frozenset(("hip", "upper_body"))
"""By the law `maturing`, the belly folds, where MIMo's pelvis and upper body slide on each other."""
THUMBS = {f"left_{name}1" for name in ("lfmetacarpal", "thbase")} | {"left_lfmetacarpal2"}
THIGHS = {"left_upper_leg1", "right_upper_leg1"}


def may_touch(geoms: dict[str, tuple[str, int, int]], parents: dict[str, str], excluded: set[frozenset]) -> set:
    """Return the pairs of geoms that contype, conaffinity and exclusions let collide."""
    found = set()
    for a, b in combinations(geoms, 2):
        (body, contype, conaffinity), (other, contype_b, conaffinity_b) = geoms[a], geoms[b]
        apart = body != other and parents[body] != other and parents[other] != body
        if apart and frozenset((body, other)) not in excluded and (contype & conaffinity_b or contype_b & conaffinity):
            found.add(frozenset((a, b)))
    return found


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_the_same_parts_collide_as_in_mimo(hands, reference):
    """But for the neck, and what MIMo's bit masks for the roots of thumb and little finger do besides.

    They let the left ones through the thighs, but not the right ones, and both, with the forearms, through the belly.
    """
    parents = {row["name"]: row["parent"] for row in reference("bodies", hands)}
    rows = reference("geoms", hands)
    masks = {row["name"]: (row["body"], int(row["contype"] or 1), int(row["conaffinity"] or 1)) for row in rows}
    excluded = {frozenset((row["first"], row["second"])) for row in reference("contacts", hands)} | OWN
    tree = grow_average(18, assemble(hands, False, "published"))
    own = {geom.name: (part.name, geom.contype, geom.conaffinity) for part in tree.bodies for geom in part.geoms}
    found = may_touch(own, parents, set(map(frozenset, tree.excluded)))
    thighs = {frozenset(pair) for pair in product(THUMBS & own.keys(), THIGHS)}
    belly = {frozenset(("cb", name)) for name, (_, contype, _) in masks.items() if contype > 2}
    belly |= {frozenset(("cb", "left_larm"))} if hands == "five_finger" else set()
    assert found - thighs - belly == {pair for pair in may_touch(masks, parents, excluded) if not pair & FILLERS}


def test_actuators_are_mimos(model, published, hands_and_chest):
    rows = published("actuators")
    assert model.nu == ACTUATORS[hands_and_chest]
    assert names(model.nu, model.actuator) == [row["name"] for row in rows]
    for row in rows:
        actuator = model.actuator(row["name"])
        assert model.joint(actuator.trnid[0]).name == row["joint"]
        assert actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT
        assert actuator.forcerange == pytest.approx(floats(row["force_range"]))
        assert list(actuator.ctrlrange) == [-1, 1]


def test_contact_exceptions_are_mimos(model, published, hands_and_chest):
    excludes = [row for row in published("contacts") if row["kind"] == "exclude"]
    (sliding,) = (row for row in published("contacts") if row["kind"] == "pair")
    assert [model.geom(pair).name for pair in (model.pair_geom1[0], model.pair_geom2[0])] == [
        sliding["first"],
        sliding["second"],
    ]
    assert (model.npair, model.pair_dim[0]) == (1, int(sliding["condim"]))
    excluded = [divmod(int(signature), 2**16) for signature in model.exclude_signature]
    found = {frozenset((model.body(a).name, model.body(b).name)) for a, b in excluded}
    rooted = {pair for pair in found if any("thbase" in name or "metacarpal" in name for name in pair)}
    assert found - rooted == {frozenset((row["first"], row["second"])) for row in excludes} | OWN
    assert len(rooted) == (6 if "five_finger" in hands_and_chest else 0), "which MIMo says with bit masks"


def test_tendons_are_mimos(model, published):
    rows = published("tendons")
    assert names(model.ntendon, model.tendon) == [row["name"] for row in rows]
    for row, first, count in zip(rows, model.tendon_adr, model.tendon_num, strict=True):
        tendon, wraps = model.tendon(row["name"]).id, slice(first, first + count)
        couples = zip(model.wrap_objid[wraps], model.wrap_prm[wraps], strict=True)
        wanted = [couple.split() for couple in row["joint_coefficients"].split(";")]
        assert [(model.joint(joint).name, factor) for joint, factor in couples] == [
            (joint, float(factor)) for joint, factor in wanted
        ]
        assert model.tendon_limited[tendon]
        assert model.tendon_range[tendon] == pytest.approx(floats(row["range_rad"]))


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_every_geom_says_what_it_follows(hands):
    for _, part in assemble(hands, False).parts:
        assert part.rule
        assert all(figures.size_from and figures.rule for figures in part.geoms), part.name


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_the_belly_folds_by_the_law_maturing(hands):
    law = {development: assemble(hands, False, development) for development in ("published", "maturing")}
    folding = {name: FOLDING in map(frozenset, anatomy.excluded) for name, anatomy in law.items()}
    assert folding == {"published": False, "maturing": True}
    assert law["maturing"].frictionless == ()
