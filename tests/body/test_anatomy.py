"""At 18 months, what does not grow is MIMo's published body to the last digit, in the order MuJoCo compiles it."""

import mujoco
import numpy as np
import pytest

from mimoc.body import anatomy

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


@pytest.fixture(scope="module")
def model(infant_at) -> mujoco.MjModel:
    return infant_at(18).model


def test_bodies_are_mimos(model, reference):
    rows = reference("bodies")
    assert names(model.nbody, model.body) == ["world", *(row["name"] for row in rows)]
    assert [model.body(model.body(row["name"]).parentid[0]).name for row in rows] == [row["parent"] for row in rows]


def test_joints_are_mimos(model, reference):
    rows = reference("joints")
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
        assert joint.frictionloss == float(row["frictionloss_nm"])
        assert joint.armature == float(row["armature_kgm2"])
        assert joint.qpos_spring == pytest.approx(np.radians(float(row["springref_deg"])))
        assert joint.solref == pytest.approx(SOLREF_LIMIT)
        assert joint.solimp == pytest.approx(SOLIMP_LIMIT)


def test_geoms_are_mimos(model, reference):
    rows = reference("geoms")
    own = [name for name in names(model.ngeom, model.geom) if model.geom(name).group == 0 and name != "floor"]
    assert own == [row["name"] for row in rows]
    for row in rows:
        geom = model.geom(row["name"])
        assert model.body(geom.bodyid[0]).name == row["body"]
        assert geom.type == GEOM_TYPES[row["type"]]
        assert geom.friction == pytest.approx(floats(row["friction"] or FRICTION)), row
        assert geom.condim == 3
        assert geom.solref == pytest.approx(SOLREF)
        assert geom.solimp == pytest.approx(SOLIMP)
        assert model.mat(geom.matid[0]).name == (row["material"] or "skin")


def test_parts_weigh_what_they_do_in_mimo(infant_at, reference):
    """A geom is compiled away into its body, so parts are compared: 23 of them."""
    masses = dict.fromkeys((row["name"] for row in reference("bodies")), 0.0)
    for row in reference("geoms"):
        masses[row["body"]] += float(row["mass_kg"])
    model = infant_at(18).model
    assert [model.body(name).mass[0] for name in masses] == pytest.approx(list(masses.values()), rel=1e-8)
    assert model.body("hip").subtreemass[0] == pytest.approx(10.905, abs=0.0005)


def test_geoms_collide_as_mimos_do(model, reference):
    """But for the belly, `cb`, and the neck, which fill gaps and collide with nothing."""
    for row in reference("geoms"):
        geom = model.geom(row["name"])
        ghost = row["name"] in ("cb", "neck")
        wanted = (0, 0) if ghost else (int(row["contype"] or 1), int(row["conaffinity"] or 1))
        assert (geom.contype[0], geom.conaffinity[0]) == wanted, row


def test_actuators_are_mimos(model, reference):
    rows = reference("actuators")
    assert names(model.nu, model.actuator) == [row["name"] for row in rows]
    assert model.nu == 44
    for row in rows:
        actuator = model.actuator(row["name"])
        assert model.joint(actuator.trnid[0]).name == row["joint"]
        assert actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT
        assert actuator.gear[0] == pytest.approx(float(row["gear_nm"]), rel=1e-8), row
        assert actuator.forcerange == pytest.approx(floats(row["force_range"]))
        assert list(actuator.ctrlrange) == [-1, 1]


def test_contact_exceptions_are_mimos(model, reference):
    pairs = [row for row in reference("contacts") if row["kind"] == "pair"]
    excludes = [row for row in reference("contacts") if row["kind"] == "exclude"]
    found = zip(model.pair_geom1, model.pair_geom2, model.pair_dim, strict=True)
    assert [(model.geom(a).name, model.geom(b).name, str(dim)) for a, b, dim in found] == [
        (row["first"], row["second"], row["condim"]) for row in pairs
    ]
    excluded = [divmod(int(signature), 2**16) for signature in model.exclude_signature]
    assert {frozenset((model.body(a).name, model.body(b).name)) for a, b in excluded} == {
        frozenset((row["first"], row["second"])) for row in excludes
    }


def test_tendons_are_mimos(model, reference):
    rows = reference("tendons")
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


def test_every_geom_says_what_it_follows():
    """No number of a body is without a reason."""
    for parts, _ in anatomy.GROUPS:
        for part in parts:
            assert part.rule
            assert all(figures.follows and figures.rule for figures in part.geoms), part.name
