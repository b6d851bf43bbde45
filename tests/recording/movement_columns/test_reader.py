"""Movement columns are what MuJoCo's data say, by names that say their units."""

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.base.errors import UnknownNameError
from mimoc.recording.movement_columns import GROUPS, groups_named
from mimoc.recording.movement_columns.reader import MovementReader, values_of

SUFFIXES = {"m": "_m", "m/s": "_m_s", "N": "_n", "N m": "_nm", "°": "_deg", "": ""}
SPECS = {
    "lying": {"age_months": 1},
    "sitting": {"age_months": 9, "scene": {"pose": "sitting"}, "actuation": {"model": "muscle"}},
    "one arm": {"age_months": 6, "body": {"remove": ["right_lower_arm"]}},
}


@pytest.fixture(scope="module", params=SPECS)
def env(request):
    """Return an infant after some random control steps."""
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "infant", "senses": {}, **SPECS[request.param]})
    with mimoc.make(spec) as opened:
        opened.reset(seed=0)
        opened.action_space.seed(0)
        for _ in range(20):
            opened.step(opened.action_space.sample())
        yield opened.unwrapped


def test_names_are_unique_and_end_with_their_units(env):
    columns = MovementReader(env).columns
    assert len({column.name for column in columns}) == len(columns)
    for column in columns:
        suffix = SUFFIXES[column.unit]
        ends = [other for other in SUFFIXES.values() if other and column.name.endswith(other)]
        assert suffix == max(ends, key=len, default=""), column
        assert all((column.about, column.source)), column
        assert not (column.is_text and column.unit)


def test_keypoints_are_those_of_the_environment_to_the_bit(env):
    values = [*MovementReader(env, ("keypoints",)).read().values()]
    assert np.array_equal(values, env.keypoints().reshape(-1), equal_nan=True)


def test_velocities_are_those_of_the_jacobian(env):
    """Of the whole body too: sum of m_i J_i qvel over the mass."""
    mujoco.mj_forward(env.model, env.data)
    values = MovementReader(env, ("parts",)).read()
    root = env.model.body(env.manifest.root_body).id
    bodies = [body for body in range(1, env.model.nbody) if env.model.body_rootid[body] == root]
    moved, jacobian = np.zeros(3), np.empty((3, env.model.nv))
    for body in bodies:
        mujoco.mj_jacBodyCom(env.model, env.data, jacobian, None, body)
        moved += env.model.body_mass[body] * (jacobian @ env.data.qvel)
    moved /= env.model.body_mass[bodies].sum()
    assert [values[f"body_velocity_{axis}_m_s"] for axis in "xyz"] == pytest.approx(moved)
    assert values["body_speed_m_s"] == pytest.approx(np.linalg.norm(moved))
    assert [values[f"body_{axis}_m"] for axis in "xyz"] == pytest.approx(env.data.subtree_com[root])


def test_forces_are_those_of_mujocos_contacts(env):
    """Each contact counts on both sides, none within a part, and what is fixed carries the body."""
    values = MovementReader(env, ("contacts",)).read()
    ground, force = np.zeros(3), np.empty(6)
    for index, contact in enumerate(env.data.contact):
        bodies = env.model.geom_bodyid[contact.geom]
        if 0 in bodies and bodies.any():
            mujoco.mj_contactForce(env.model, env.data, index, force)
            ground += (1 if bodies[0] == 0 else -1) * (contact.frame.reshape(3, 3).T @ force[:3])
    assert [values[f"ground_reaction_{axis}_n"] for axis in "xyz"] == pytest.approx(ground)
    loads = [value for name, value in values.items() if name.endswith("_ground_z_n")]
    assert sum(loads) == pytest.approx(ground[2])
    for name, text in values.items():
        if name.endswith("_touches"):
            part = name.removesuffix("_touches")
            assert bool(text) == (values[f"{part}_contact_n"] > 0)
            assert part not in text.split("; ")


def test_the_gaze_point_lies_on_the_line_of_sight(env):
    values = MovementReader(env, ("gaze",)).read()
    towards = np.array([values[f"gaze_direction_{axis}"] for axis in "xyz"])
    assert np.linalg.norm(towards) == pytest.approx(1)
    if values["gaze_at"]:
        eyes_m = np.mean([env.data.camera(eye.camera).xpos for eye in env.manifest.anatomy.eyes], axis=0)
        point_m = np.array([values[f"gaze_{axis}_m"] for axis in "xyz"])
        assert point_m == pytest.approx(eyes_m + values["gaze_distance_m"] * towards)
    else:
        assert np.isnan(values["gaze_x_m"])


def test_many_moments_at_once_are_those_of_each(env):
    reader, samples, alone = MovementReader(env), [], []
    for _ in range(5):
        env.step(env.action_space.sample())
        reader.add(samples, 5)
        alone.append(reader.read())
    numbers, texts = values_of(samples)
    for row, names, values in zip(numbers, texts, alone, strict=True):
        expected = [*values.values()]
        assert row.tolist() == pytest.approx(expected[: len(row)], rel=1e-12, nan_ok=True)
        assert [*names] == expected[len(row) :]


def test_groups_are_chosen_by_name_in_the_order_of_the_table():
    assert groups_named("contacts, keypoints") == ("keypoints", "contacts")
    assert (groups_named("all"), groups_named("none")) == (tuple(GROUPS), ())
    with pytest.raises(UnknownNameError, match="'gase' is not a group of movement columns; did you mean 'gaze'"):
        groups_named("gase")
