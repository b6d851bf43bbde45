"""Code written for MIMo finds what it looks for; a bundle for it is the same infant, and one of mimoc's as any other.

`tests/reference/*/lookups.csv` has the names that MIMo 1.1 looks up in its own models, in the order they have there.
MIMo 3 has the same ones, two joints of a chest besides, its head after the arms, and other names of geoms.
"""

import csv
import json
import pickle
from contextlib import closing
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml
from gymnasium.spaces import Box
from support import store
from support.full import full_but
from typer.testing import CliRunner

import mimoc
from mimoc.base.errors import UnknownNameError
from mimoc.body.strength import FASTEST_RAD_S
from mimoc.bundle.model import load_model
from mimoc.cli.commands import app
from mimoc.compiler.building import builder
from mimoc.compiler.explain import entries_of
from mimoc.compiler.measuring import measure_body
from mimoc.compiler.mjcf.mimo import TARGETS
from mimoc.components.actuation.muscle import MIMOS
from mimoc.runtime.check import check_stability

ROOT = Path(__file__).parents[3]
CONFIGS = sorted((ROOT / "configs").glob("*.yaml"))
DIFFERENT = [path for path in CONFIGS if path.stem in ("all_senses", "five_finger", "muscle", "one_arm", "reach")]
"""Those that have, between them, whatever MIMo's code looks up."""
COUNTS = {  # How many objects of each kind a model has.
    "joint": "njnt",
    "actuator": "nu",
    "sensor": "nsensor",
    "equality": "neq",
    "body": "nbody",
    "geom": "ngeom",
    "texture": "ntex",
    "camera": "ncam",
    "material": "nmat",
    "site": "nsite",
}


def spec(**keys) -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "infant", "age_months": 18, **keys})


def names(model: mujoco.MjModel, kind: str) -> list[str]:
    """Return the names of all objects of a kind, in the order of the model; those without one are left out."""
    return [name for index in range(getattr(model, COUNTS[kind])) if (name := getattr(model, kind)(index).name)]


def looked_up(hands: str) -> dict[str, list[str]]:
    """Return the names that MIMo's code looks up, by kind, in the order of its own model."""
    with (ROOT / "tests" / "reference" / hands / "lookups.csv").open() as file:
        found: dict[str, list[str]] = {}
        for row in csv.DictReader(file):
            found.setdefault(row["kind"], []).append(row["name"])
    return found


@pytest.fixture(scope="module", params=full_but(DIFFERENT, CONFIGS), ids=lambda path: path.stem)
def pair(request) -> tuple[mimoc.InfantSpec, mimoc.Bundle, mimoc.Bundle]:
    """Return a config, its bundle, and its bundle for MIMo."""
    wanted = mimoc.load_spec(request.param)
    return wanted, store.built(request.param), mimoc.build(wanted, "mimo")


# What every bundle has.


def test_every_bundle_has_what_costs_nothing(pair):
    wanted, bundle, _ = pair
    model, theirs = load_model(bundle), looked_up(wanted.body.hands)
    for kind in ("texture", "material"):
        assert set(theirs[kind]) <= set(names(model, kind))
    hinges = [name for name in names(model, "joint") if name.startswith("robot:")]
    assert [name for name in names(model, "equality") if name.startswith("robot:")] == hinges
    assert model.nuser_actuator == 3


def test_lights_are_written_as_older_mujocos_read_them(pair):
    text = pair[1].files["scene.xml"].decode()
    lights = [line for line in text.splitlines() if "<light " in line]
    assert all(" directional=" in line and " type=" not in line for line in lights)
    model = load_model(pair[1])
    kinds = {True: mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, False: mujoco.mjtLightType.mjLIGHT_SPOT}
    assert model.light_type.tolist() == [kinds['directional="true"' in line] for line in lights]


def test_only_locked_joints_have_active_locks(pair):
    model, locked = load_model(pair[1]), {lock.joint for lock in pair[1].manifest.constraints.locks}
    active = {name for name in names(model, "equality") if model.equality(name).active0[0]}
    assert {name for name in active if name.startswith("robot:")} == locked


def test_a_lock_that_is_switched_on_holds_its_joint():
    """As MIMo's code locks a joint: the angle among the constraint's numbers, then the constraint active."""
    model = load_model(mimoc.build(spec()))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("supine").id)
    knee = data.joint("robot:left_knee")
    model.equality("robot:left_knee").data[0] = knee.qpos[0]
    data.eq_active[model.equality("robot:left_knee").id] = 1
    before = knee.qpos[0]
    data.ctrl[model.actuator("act:left_knee").id] = 1.0
    mujoco.mj_step(model, data, 100)
    assert knee.qpos[0] == pytest.approx(before, abs=0.05)


MIMOS_HIP_ROTATION_DEG = 32 + 41
ODD = {"act:hip_lean", "act:chest_twist", "act:chest_lean"}
"""Muscles to which MIMo gives a tenth, or up to ten times, of the strength of their motor."""


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_motors_bring_the_parameters_of_their_muscles(hands):
    """At 18 months forces are MIMo's own, but for those of a few joints; muscles pull up to 35 rad/s of any joint."""
    model = load_model(mimoc.build(spec(body={"hands": hands})))
    ratios, speeds_rad_s = [], []
    with (ROOT / "tests" / "reference" / hands / "actuators.csv").open() as file:
        for row in csv.DictReader(file):
            if row["name"] in names(model, "actuator") and row["name"] not in ODD:
                vmax, *fmax = model.actuator(row["name"]).user
                theirs = [float(row[key]) for key in ("fmax_negative", "fmax_positive")]
                stronger = float(row["gear_nm"]) / model.actuator(row["name"]).gear[0]  # How much MIMo's motor is.
                ratios.append(np.array(fmax) / theirs * stronger / _wider(row, model))
                speeds_rad_s.append(vmax * np.ptp(model.joint(row["joint"]).range) / MIMOS.width)
    assert np.median(ratios, axis=0) == pytest.approx([1, 1], abs=0.02)
    assert np.min(ratios) > 0.65
    assert np.max(ratios) < 1.1
    assert np.min(speeds_rad_s) > FASTEST_RAD_S * (1 - 1e-6)


def _wider(row: dict[str, str], model: mujoco.MjModel) -> float:
    """Return how much wider the joint's range is than MIMo's: hips turn further, by muscles of a shorter moment arm."""
    if "hip_rotation" not in row["name"]:
        return 1.0
    return float(np.ptp(model.joint(row["joint"]).range)) / np.radians(MIMOS_HIP_ROTATION_DEG)


# What a bundle for MIMo has.


def test_names_come_in_mimos_order(pair):
    """All of them where the body is whole, those that are there of others; only a chest's joints are not MIMo's."""
    wanted, _, bundle = pair
    model, theirs = load_model(bundle), looked_up(wanted.body.hands)
    for kind in ("joint", "actuator", "sensor"):
        prefix = "robot:" if kind == "joint" else ""
        ours = [name for name in names(model, kind) if name.startswith(prefix) and "chest" not in name]
        if wanted.actuation.model == "muscle" and kind == "actuator":
            ours = [name.removesuffix("_negative") for name in ours if name.endswith("_negative")]
        assert ours == [name for name in theirs[kind] if name in ours]
        if not wanted.body.remove:
            assert len(ours) == len(theirs[kind])


def test_parts_skin_and_cameras_are_there(pair):
    wanted, _, bundle = pair
    model, theirs = load_model(bundle), looked_up(wanted.body.hands)
    if not wanted.body.remove:
        assert set(theirs["body"]) | set(theirs["skin"]) <= set(names(model, "body"))
        assert set(theirs["camera"]) <= set(names(model, "camera"))
    assert {"corner", "top", "side1", "side2", "closeup"} <= set(names(model, "camera"))
    assert_is_located(model)
    assert ("chest" in names(model, "body")) == wanted.body.chest_joint
    hinges = {name for name in names(model, "joint") if "chest" not in name}
    assert set(theirs["equality"]) & hinges <= set(names(model, "equality"))


def assert_is_located(model: mujoco.MjModel) -> None:
    assert names(model, "joint")[0] == names(model, "body")[1] == "mimo_location"
    assert model.body("hip").parentid[0] == model.body("mimo_location").id


def test_what_is_to_be_touched_comes_last_among_the_angles():
    model = load_model(mimoc.build(spec(task={"kind": "reach"}), "mimo"))
    assert model.joint("target_joint").qposadr[0] == model.nq - 7
    assert model.body("target").jntadr[0] == model.joint("target_joint").id


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_effectors_look_out_of_face_eyes_and_palms(hands):
    model = load_model(mimoc.build(spec(body={"hands": hands}), "mimo"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for side, sign in (("left", 1), ("right", -1)):
        eye = data.site(f"eef:{side}_eye").xmat.reshape(3, 3)[:, 2]
        assert eye == pytest.approx(-data.cam(f"eye_{side}").xmat.reshape(3, 3)[:, 2], abs=1e-6)
        hand = data.body(f"{side}_hand").xmat.reshape(3, 3)
        assert data.site(f"eef:{side}_hand").xmat.reshape(3, 3)[:, 2] == pytest.approx(sign * hand[:, 1], abs=1e-6)
    head = data.body("head").xmat.reshape(3, 3)
    assert data.site("eef:head").xmat.reshape(3, 3)[:, 2] == pytest.approx(head[:, 0], abs=1e-6)
    for mark in ("target:head", "target:left_hand", "target:right_hand"):
        assert model.body(mark).mocapid[0] >= 0


# What a bundle for MIMo 3 has.


@pytest.fixture(scope="module", params=["mitten", "five_finger"])
def third(request) -> tuple[mimoc.Bundle, mimoc.Bundle]:
    """Return the bundle of an infant whose chest has joints, and that for MIMo 3 of one whose spec does not say."""
    senses = {"proprioception": {}, "vestibular": {}}
    plain = spec(body={"hands": request.param, "chest_joint": True}, senses=senses)
    return mimoc.build(plain), mimoc.build(spec(body={"hands": request.param}, senses=senses), "mimo3")


def hands_of(bundle: mimoc.Bundle) -> str:
    return mimoc.InfantSpec.model_validate(yaml.safe_load(bundle.files["resolved.yaml"])).body.hands


def test_mimo_3_finds_its_motors_and_an_observation_of_its_length(third):
    for bundle in third:
        with closing(mimoc.InfantEnv(bundle)) as env:
            observation, _ = env.reset(seed=0)
            assert observation["proprioception"].shape == ({46: 305, 90: 621}[env.model.nu],)


def test_names_come_in_the_order_of_mimo_3(third):
    """They are MIMo's, in MIMo's order, but the head's joints come after the arms', and there are those of a chest."""
    model = load_model(third[1])
    theirs = looked_up(hands_of(third[1]))
    for kind in ("actuator", "sensor"):
        assert [name for name in names(model, kind) if "chest" not in name] == theirs[kind]
    hinges = names(model, "joint")[1:]
    head = [name for name in theirs["joint"] if "head" in name or "eye" in name]
    rest = [name for name in theirs["joint"] if name not in head]
    legs = next(number for number, name in enumerate(rest) if name == "robot:right_hip1")
    assert hinges[6:8] == ["robot:chest_lean", "robot:chest_rot"]
    assert [*hinges[:6], *hinges[8:]] == [*rest[:legs], *head, *rest[legs:]]
    assert names(model, "actuator")[3:5] == ["act:chest_twist", "act:chest_lean"]
    assert names(model, "sensor")[4:7] == ["proprio:right_eye", "proprio:chest", "proprio:trunk_upper"]


def test_parts_of_mimo_3_are_there(third):
    model = load_model(third[1])
    theirs = looked_up(hands_of(third[1]))
    assert_is_located(model)
    assert {*theirs["body"], *theirs["skin"], "chest"} <= set(names(model, "body"))
    for kind in ("texture", "material"):
        assert set(theirs[kind]) <= set(names(model, kind))
    assert set(theirs["equality"]) | {"robot:chest_lean", "robot:chest_rot"} <= set(names(model, "equality"))
    assert [name for name in names(model, "site") if name.startswith("eef:")] == []


def test_geoms_that_are_numbered_after_their_body_have_the_prefix_of_mimo_3(third):
    plain, other = map(load_model, third)
    unnumbered = {"lb", "cb", "ub1", "ub2", "ub3", "neck", "head"}
    unnumbered |= {"nose", "floor"}
    unnumbered |= {f"{side}_{part}" for side in ("left", "right") for part in ("uarm1", "larm", "ear")}
    for old, new in zip(names(plain, "geom"), names(other, "geom"), strict=True):
        assert new == (old if old in unnumbered else f"geom:{old}")


def test_a_chest_that_is_to_be_rigid_stays_rigid_for_mimo_3():
    bundle = mimoc.build(spec(body={"chest_joint": False}), "mimo3")
    model = load_model(bundle)
    assert model.nu == 44
    assert "'body.chest_joint' is false" in bundle.manifest.notes[1]
    assert "chest" in names(model, "body")


def test_provenance_names_the_elements_of_a_bundle_for_mimo_3(third):
    bundle = third[1]
    model, entries = load_model(bundle), entries_of(bundle)
    places = [entry["xml"] for entry in entries.values() if "geom[@name='" in entry.get("xml", "")]
    assert {place.split("'")[1] for place in places} <= set(names(model, "geom"))
    assert any("'geom:left_hand1'" in place for place in places)
    assert all(source in entries for entry in entries.values() for source in entry.get("from", ()))
    assert "geom:left_hand1" not in json.dumps(list(entries_of(third[0])))


# The same infant.


def test_it_is_the_same_infant(pair):
    """Every geom is where it was in every pose, joints turn the same masses, and only the names' order is another."""
    _, plain, other = (load_model(bundle) if isinstance(bundle, mimoc.Bundle) else bundle for bundle in pair)
    orders = [
        [model.joint(name).dofadr[0] for name in names(plain, "joint") if "robot:" in name] for model in (plain, other)
    ]
    for pose in pair[1].manifest.poses:
        states = []
        for model, dofs in zip((plain, other), orders, strict=True):
            data = mujoco.MjData(model)
            mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
            mujoco.mj_forward(model, data)
            inertia = np.zeros((model.nv, model.nv))
            for dof in range(model.nv):
                mujoco.mj_mulM(model, data, inertia[dof], np.eye(model.nv)[dof])
            states.append((inertia[np.ix_(dofs, dofs)], data))
        (first, before), (second, after) = states
        assert second == pytest.approx(first, abs=1e-9)
        for geom in range(plain.ngeom):
            name = plain.geom(geom).name
            if name.startswith("object_mobile"):  # It hangs above the chest, which is one with the upper body for MIMo.
                continue
            assert after.geom(name).xpos == pytest.approx(before.geom(name).xpos, abs=1e-7)


@pytest.mark.parametrize("target", TARGETS)
def test_it_measures_the_same(target):
    """A report has the same measurements, whatever the names of geoms and whoever moves freely."""
    wanted = spec(body={"hands": "five_finger", "chest_joint": True})
    plain, other = (measure_body(load_model(mimoc.build(wanted, name))) for name in (None, target))
    assert other == pytest.approx(plain, abs=1e-7)


@pytest.mark.parametrize("target", TARGETS)
def test_servos_for_mimo_push_as_mimocs_do(target):
    """Towards the same angles, from the same angles, whatever the command: theirs is the angle itself, in radians."""
    wanted = spec(actuation={"model": "position"}, scene={"kind": "empty"}, body={"chest_joint": False})
    plain, other = (mimoc.InfantEnv(mimoc.build(wanted, convention)) for convention in (None, target))
    assert isinstance(other.action_space, Box)
    limits = other.model.jnt_range[other.model.actuator_trnid[:, 0]]
    assert np.column_stack([other.action_space.low, other.action_space.high]) == pytest.approx(limits, abs=1e-6)
    generator, servos = np.random.default_rng(0), names(plain.model, "actuator")
    for _ in range(20):
        command, place = generator.uniform(-1, 1, 44), generator.uniform(0, 1, 44)
        for env, reached in ((plain, command), (other, limits.mean(axis=1) + command * np.ptp(limits, axis=1) / 2)):
            for name, angle, where in zip(servos, reached, place, strict=True):
                servo = env.model.actuator(name)
                low, high = env.model.jnt_range[servo.trnid[0]]
                env.data.joint(servo.trnid[0]).qpos = low + where * (high - low)
                env.data.act[env.model.actuator_actadr[servo.id]] = angle
            mujoco.mj_forward(env.model, env.data)
        assert other.data.actuator_force == pytest.approx(plain.data.actuator_force, rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("target", TARGETS)
def test_motors_for_mimo_have_the_same_tone(target):
    """Built quiet or slack, or made slack by mimoc's own reset."""
    plain, quiet, slack = (
        mimoc.InfantEnv(
            mimoc.build(spec(age_months=0, body={"chest_joint": False}, actuation={"arousal": arousal}), name)
        )
        for arousal, name in ((1, None), (1, target), (0, target))
    )
    for name in names(plain.model, "actuator"):
        assert quiet.model.actuator(name).biastype == mujoco.mjtBias.mjBIAS_AFFINE
        assert quiet.model.actuator(name).biasprm == pytest.approx(plain.model.actuator(name).biasprm)
    assert np.abs(quiet.model.actuator_biasprm[:, :2]).max() > 0
    quiet.reset(options={"arousal": 0})
    for env in (quiet, slack):
        assert np.abs(env.model.actuator_biasprm).max() < 1e-9


# One of mimoc's bundles.


def assert_is_calm(bundle: mimoc.Bundle, target: str) -> None:
    assert bundle.manifest.notes[0].startswith(f"built for {target}:")
    assert bundle.manifest.root_body == "mimo_location"
    assert all(check.passed for check in check_stability(bundle))


def test_a_bundle_for_mimo_is_calm_and_says_what_it_is(pair):
    assert_is_calm(pair[2], "mimo")


def test_a_bundle_for_mimo_3_is_calm_and_says_what_it_is(third):
    assert_is_calm(third[1], "mimo3")


def test_mimoc_runs_a_bundle_for_mimo():
    wanted = spec(
        senses={"proprioception": {}, "vestibular": {}, "touch": {}},
        scene={"kind": "crib", "held": ["chest"]},
        actuation={"locked": ["legs"]},
    )
    bundle = mimoc.build(wanted, "mimo")
    assert [weld.body for weld in bundle.manifest.constraints.welds] == ["upper_body"]
    with closing(mimoc.InfantEnv(bundle)) as env:
        observation, _ = env.reset(seed=0)
        held = env.data.body("upper_body").xpos.copy()
        for _ in range(20):
            observation, *_ = env.step(env.action_space.sample())
        assert all(np.isfinite(part).all() for part in observation.values())
        assert env.data.body("upper_body").xpos == pytest.approx(held, abs=0.005)


@pytest.mark.parametrize("target", TARGETS)
def test_a_builder_takes_its_convention_along(target):
    compiler = builder(spec(), target)
    assert pickle.loads(pickle.dumps(compiler))(0).files == compiler(0).files == mimoc.build(spec(), target).files


@pytest.mark.parametrize("target", TARGETS)
def test_the_command_builds_for_mimo_and_for_nobody_else(tmp_path, target):
    config, out = str(ROOT / "configs" / "newborn.yaml"), tmp_path / "out"
    done = CliRunner().invoke(app, ["build", config, "-o", str(out), "--for", target])
    assert done.exit_code == 0
    assert mimoc.read_bundle(out).files == mimoc.build(mimoc.load_spec(config), target).files
    refused = CliRunner().invoke(app, ["build", config, "-o", str(tmp_path / "no"), "--for", "mino"])
    assert "'mino' is not a system to build for; did you mean 'mimo' or 'mimo3'?" in str(refused.exception)
    assert not (tmp_path / "no").exists()


def test_the_known_conventions_are_named_where_one_is_unknown():
    assert set(TARGETS) == {"mimo", "mimo3"}
    with pytest.raises(UnknownNameError, match="'nobody' is not a system to build for; choose from mimo, mimo3"):
        mimoc.build(spec(), "nobody")
