from collections.abc import Iterator, Mapping
from functools import cache
from itertools import pairwise, product
from types import SimpleNamespace
from typing import Any, get_args

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.touch_oracle import touch_loop

import mimoc
from mimoc.bundle.model import load_model
from mimoc.senses.touch.run import MAX_FORCE_N, QUANTITIES, RESPONSES, Touch, bind
from mimoc.senses.touch.spec import POINTS, SkinEntry, TouchEntry, TouchQuantity, TouchResponse

G_M_S2 = 9.81
WORLD = """
<mujoco>
  <option cone="elliptic"/>
  <worldbody><geom name="floor" type="plane" size="1 1 1" {floor}/>{bodies}</worldbody>
</mujoco>
"""
BALL = '<body name="{name}" pos="{pos}" euler="{euler}"><freejoint/><geom size="0.05" mass="1" {geom}/></body>'
BOTTOM = (0, 0, -0.05)


def world(*bodies, floor=""):
    """Return a simulation of some bodies above a floor."""
    model = mujoco.MjModel.from_xml_string(WORLD.format(floor=floor, bodies="".join(bodies)))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


def ball(name="ball", pos="0 0 0.049", euler="0 0 0", geom=""):
    """Return a ball of 5 cm and 1 kg; it stands 1 mm in the floor unless it is put elsewhere."""
    return BALL.format(name=name, pos=pos, euler=euler, geom=geom)


def skin(
    data, points_m: Mapping[str, list], spacing_m=0.01, quantity="force_vector_global", response="linear"
) -> Touch:
    """Return the touch of some points of some bodies."""
    parts = tuple(SkinEntry(body=name, points=len(points), spacing_m=spacing_m) for name, points in points_m.items())
    entry = TouchEntry(quantity=quantity, response=response, skin=parts)
    stand_in: Any = SimpleNamespace(arrays={POINTS: np.concatenate([np.array(points) for points in points_m.values()])})
    return bind(entry, data.model, stand_in)


def points(sample):
    """Return a sample of vectors point by point."""
    return sample.reshape(-1, 3)


def contact_forces(data):
    """Return what MuJoCo says of contacts: of each the two bodies and the force on the second, in the world."""
    for index in range(data.ncon):
        wrench = np.zeros(6)
        mujoco.mj_contactForce(data.model, data, index, wrench)
        contact = data.contact[index]
        yield data.model.geom_bodyid[contact.geom], contact.frame.reshape(3, 3).T @ wrench[:3]


# One thing that touches another.


def test_the_floor_pushes_up():
    data = world(ball())
    (force,) = points(skin(data, {"ball": [BOTTOM]})(data))
    assert force[2] > 0
    assert force[:2] == pytest.approx([0, 0], abs=1e-9)


def test_a_body_at_rest_senses_its_weight():
    data = world('<body name="box" pos="0 0 0.05"><freejoint/><geom type="box" size="0.05 0.05 0.05" mass="2"/></body>')
    corners = list(product((-0.05, 0.05), repeat=3))
    touch = skin(data, {"box": corners})
    mujoco.mj_step(data.model, data, 1000)
    forces = points(touch(data))
    assert forces.sum(axis=0) == pytest.approx([0, 0, 2 * G_M_S2], abs=1e-3)
    below = np.array(corners)[:, 2] < 0
    assert forces[below, 2] == pytest.approx(np.full(4, 2 * G_M_S2 / 4), rel=1e-2)
    assert not forces[~below].any()


def test_a_fingertip_senses_its_share_of_the_weight():
    """A rod that turns about one end, and rests on the floor with the other: half of its weight."""
    rod = """
    <body name="rod" pos="0 0 0.01">
      <joint type="hinge" axis="0 1 0" damping="0.1"/>
      <geom type="box" size="0.1 0.001 0.001" pos="0.1 0 0" mass="0.3" contype="0" conaffinity="0"/>
      <body name="tip" pos="0.2 0 0"><geom size="0.01" mass="1e-6"/></body>
    </body>"""
    data = world(rod)
    touch = skin(data, {"rod": [(0.2, 0, -0.01)], "tip": [(0, 0, -0.01)]})
    mujoco.mj_step(data.model, data, 2000)
    assert points(touch(data))[:, 2] == pytest.approx([0, 0.3 * G_M_S2 / 2], rel=1e-3)


def test_friction_is_sensed_too():
    """A ball that slides along x and y is held back."""
    data = world(ball())
    touch = skin(data, {"ball": [BOTTOM]})
    data.qvel[:2] = 1.0, -0.5
    mujoco.mj_forward(data.model, data)
    (force,) = points(touch(data))
    assert force[:2] / force[2] == pytest.approx(np.array([-1, 0.5]) / np.sqrt(1.25), rel=1e-2)


def test_without_friction_only_the_normal_force_is_sensed():
    """The rows of MuJoCo's forces that follow are then those of the next contact."""
    data = world(ball(geom='condim="1"'), ball("other", "1 0 0.04", geom='condim="1"'), floor='condim="1"')
    forces = points(skin(data, {"ball": [BOTTOM], "other": [BOTTOM]})(data))
    assert forces[:, :2] == pytest.approx(np.zeros((2, 2)), abs=1e-9)
    assert (forces[:, 2] == data.efc_force).all()
    assert forces[1, 2] > forces[0, 2] > 0


def test_a_force_is_sensed_in_the_frame_of_the_body():
    """A ball that lies on its left side is pushed to its right by the floor."""
    data = world(ball(euler="-90 0 0"))
    left = {"ball": [(0, 0.05, 0)]}
    force = skin(data, left, quantity="force_vector")(data)
    pressure = skin(data, left, quantity="normal")(data)
    assert force == pytest.approx([0, -pressure[0], 0], abs=1e-9)


@pytest.mark.parametrize("order", [1, -1])
def test_both_bodies_sense_the_same_contact_each_on_its_own_surface(order):
    """A ball that is 4 mm inside another."""
    data = world(*[ball("low", "0 0 0.5"), ball("high", "0 0 0.596")][::order])
    near_the_surface = [(0, 0, sign * height) for sign in (-1, 1) for height in (0.05, 0.0485, 0.046)]
    touch = skin(data, {"low": near_the_surface, "high": near_the_surface}, response="nearest")
    low, high = (points(touch(data))[touch.receptors.names == name] for name in ("low", "high"))
    assert np.flatnonzero(low.any(axis=1)).tolist() == [3]
    assert np.flatnonzero(high.any(axis=1)).tolist() == [0]
    assert high[0, 2] > 0
    assert (low[3] == -high[0]).all()


def test_a_share_falls_with_the_distance_to_nothing_at_two_spacings():
    data = world(ball())
    row = [(x, 0, -0.05) for x in (0.0, 0.01, -0.015, 0.02, 0.03)]
    forces = points(skin(data, {"ball": row}, spacing_m=0.01)(data))
    assert forces[:, 2] / forces[:, 2].sum() == pytest.approx(np.array([1, 0.5, 0.25, 0, 0]) / 1.75, abs=1e-9)
    assert forces.sum() == pytest.approx(data.efc_force[0])


def test_the_nearest_point_alone_can_respond():
    data = world(ball())
    row = [(x, 0, -0.05) for x in (0.006, -0.005, 0.01)]
    forces = points(skin(data, {"ball": row}, response="nearest")(data))
    assert forces[:, 2].tolist() == [0, data.efc_force[0], 0]


@pytest.mark.parametrize("others", [[], [(0, 0, 0.05), (0.05, 0, 0)]])
def test_a_contact_far_from_every_point_goes_to_the_nearest(others):
    """Also where a skin has but one."""
    data = world(ball(), ball("near", "0.2 0 0.5"))
    lonely = (0.03, 0, -0.04)
    forces = points(skin(data, {"ball": [lonely, *others], "near": [BOTTOM]}, spacing_m=0.001)(data))
    assert forces[:, 2].tolist() == [data.efc_force[0], *[0] * len(others), 0]


def test_two_touches_of_one_point_add_up():
    data = world(ball(), ball("above", "0 0 0.148"))
    touch = skin(data, {"ball": [(0, 0, 0)]}, quantity="normal")
    assert touch(data) == pytest.approx([data.efc_force[[0, 3]].sum()])


def test_only_skin_senses():
    """A ball without skin does not, nor does the floor."""
    data = world(ball(), ball("toy", "1 0 0.049"), ball("next", "0.91 0 0.049"))
    touch = skin(data, {"ball": [BOTTOM]})
    assert data.ncon == 4
    assert points(touch(data))[0, 2] == pytest.approx(data.efc_force[0])


def test_what_is_only_near_is_not_sensed():
    """MuJoCo lists such contacts, but not among those that push; which they are, 3.17 sees another way."""
    gaps = [world(ball(pos="0 0 0.055"), floor=f'margin="{margin_m}" gap="0.01"') for margin_m in (0.01, 0)]
    data = next(data for data in gaps if (data.contact.efc_address == -1).any())
    assert not skin(data, {"ball": [BOTTOM]})(data).any()


def test_cloth_is_sensed():
    """It has no geoms: MuJoCo counts it as geom -1, which is not the last one."""
    cloth = """<flexcomp name="cloth" type="grid" dim="2" count="3 3 1" spacing="0.1 0.1 0.1" radius="0.005" mass="1"
               pos="0 0 0.5"><contact selfcollide="none"/></flexcomp>"""
    data = world(cloth, ball(pos="0 0 0.553"), ball("last", "1 0 0.5"))
    assert (data.contact.geom == -1).any()
    low, last = points(skin(data, {"ball": [BOTTOM], "last": [BOTTOM]})(data))
    assert low[2] > 0
    assert not last.any()


def test_no_touch_is_all_zeros():
    data = world(ball(pos="0 0 1"))
    sample = skin(data, {"ball": [BOTTOM, (0, 0, 0.05)]})(data)
    assert sample.shape == (6,)
    assert not sample.any()


@pytest.mark.parametrize(("quantity", "low"), [("force_vector", -MAX_FORCE_N), ("normal", 0)])
@pytest.mark.parametrize("force_n", [1e6, -1e6])
def test_what_is_observed_keeps_to_its_bounds(quantity, low, force_n):
    touch = skin(world(ball()), {"ball": [BOTTOM]}, quantity=quantity)
    sample = np.full(touch.spaces["touch"].shape, force_n)
    observed = touch.observe(sample)["touch"]
    assert observed in touch.spaces["touch"]
    assert (observed == np.clip(force_n, low, MAX_FORCE_N)).all()


# Infants.


@cache
def built(age_months, hands, pose, **touch) -> mimoc.Bundle:
    """Return an infant on a floor."""
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": {"hands": hands}}
    spec |= {"senses": {"touch": touch}, "scene": {"kind": "flat", "pose": pose}}
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


def infant(age_months=9, hands="mitten", pose="supine", quantity="force_vector", response="linear"):
    """Return the touch of an infant, its simulation in a pose, and the loop that it should equal."""
    bundle = built(age_months, hands, pose)
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    entry = bundle.manifest.senses.touch.model_copy(update={"quantity": quantity, "response": response})
    return bind(entry, model, bundle), data, touch_loop(entry, bundle, model)


def tangled(data, count, height_m=0) -> Iterator[mujoco.MjData]:
    """Put an infant anyhow: bent, turned and moving, its limbs in each other and in the floor, or high in the air."""
    random = np.random.default_rng(0)
    low, high = data.model.jnt_range[1:].T
    for _ in range(count):
        root_m = random.uniform([0, 0, height_m], [1, 1, height_m + 0.1])
        data.qpos[:] = *root_m, *random.normal(size=4), *random.uniform(low, high)
        data.qvel[:] = random.normal(size=data.model.nv)
        mujoco.mj_forward(data.model, data)
        yield data


def moving(data, count) -> Iterator[mujoco.MjData]:
    """Let an infant move at random."""
    random = np.random.default_rng(0)
    for _ in range(count):
        data.ctrl[:] = random.uniform(-1, 1, data.model.nu)
        mujoco.mj_step(data.model, data, 5)
        yield data


def by_body(touch, data):
    """Return the sum of the forces on the points of each body, shape (nbody, 3), in the world."""
    total = np.zeros((data.model.nbody, 3))
    np.add.at(total, touch.receptors.bodies, touch.skin_state(data).forces)
    return total


@pytest.fixture(scope="module", params=[(0, "mitten"), (9, "five_finger"), (24, "mitten")], ids=str)
def child(request):
    age_months, hands = request.param
    return infant(age_months, hands)[:2]


@pytest.mark.parametrize("response", get_args(TouchResponse))
@pytest.mark.parametrize("quantity", get_args(TouchQuantity))
@pytest.mark.parametrize(
    ("age_months", "hands", "pose"), [(0, "mitten", "supine"), (9, "five_finger", "sitting"), (24, "mitten", "prone")]
)
def test_it_equals_a_loop_over_all_points(age_months, hands, pose, quantity, response):
    touch, data, loop = infant(age_months, hands, pose, quantity=quantity, response=response)
    touched = 0
    for states in (moving(data, 40), tangled(data, 15)):
        for state in states:
            wanted = loop(state)
            touched += wanted.any()
            assert_allclose(touch(state), wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())
    assert touched > 30


@pytest.mark.matrix
def test_the_forces_on_the_points_of_a_body_add_up_to_the_contact_forces_on_it(child):
    """In every direction, to the last digits."""
    touch, data = child
    skinned = np.unique(touch.bodies)
    assert len(skinned) > 20
    touched = np.zeros(3, int)
    for state in tangled(data, 30):
        wanted = np.zeros((state.model.nbody, 3))
        for (first, second), force in contact_forces(state):
            wanted[first] -= force
            wanted[second] += force
        assert_allclose(by_body(touch, state)[skinned], wanted[skinned], rtol=1e-9, atol=1e-9 * np.abs(wanted).max())
        touched += (wanted[skinned] != 0).sum(axis=0)
    assert (touched > 60).all()


def test_a_touch_of_oneself_is_sensed_twice_with_opposite_forces(child):
    touch, data = child
    touched = 0
    for state in tangled(data, 30, height_m=10):
        forces = by_body(touch, state)
        touched += forces.any(axis=1).sum()
        assert_allclose(forces.sum(axis=0), 0, atol=1e-9 * np.abs(forces).sum() + 1e-12)
    assert touched > 20


def test_reading_changes_nothing(child):
    """Not MuJoCo's arrays, and so not what is read next."""
    touch, data = child
    contact = data.contact
    for _ in tangled(data, 5):
        mujoco_s = [contact.frame, contact.pos, contact.geom, contact.dist, data.efc_force, data.xmat, data.xpos]
        before = [array.copy() for array in mujoco_s]
        first, state, again = touch(data), touch.skin_state(data), touch(data)
        assert (first == again).all()
        assert not np.shares_memory(first, again)
        assert (state.forces == touch.skin_state(data).forces).all()
        assert all((array == copy).all() for array, copy in zip(mujoco_s, before, strict=True))


@pytest.mark.matrix
@pytest.mark.parametrize("pose", ["supine", "prone"])
def test_an_infant_at_rest_senses_its_weight(pose):
    touch, data, _ = infant(pose=pose)
    mujoco.mj_step(data.model, data, 1500)
    weight_n = data.model.body_mass.sum() * G_M_S2
    assert touch.skin_state(data).forces.sum(axis=0) == pytest.approx([0, 0, weight_n], abs=0.01 * weight_n)


def test_the_quantities_are_of_one_force():
    """In the body's frame, in the world's, and its part along the normal."""
    (on_body, data, _), (in_world, *_), (normal, *_) = (infant(quantity=quantity) for quantity in QUANTITIES)
    for state in tangled(data, 20):
        world_from_body = state.xmat[on_body.receptors.bodies].reshape(-1, 3, 3)
        forces, pressures = points(in_world(state)), normal(state)
        turned = np.einsum("nij,nj->ni", world_from_body, points(on_body(state)))
        assert_allclose(turned, forces, atol=1e-12 * np.abs(forces).max())
        assert ((pressures > 0) == forces.any(axis=1)).all()


def test_pressures_add_up_to_the_normal_forces(child):
    touch, data = child
    normal = Touch(touch.receptors, data.model, QUANTITIES["normal"], RESPONSES["linear"])
    skinned = np.isin(np.arange(data.model.nbody), touch.bodies)
    for state in tangled(data, 20):
        sides = skinned[state.model.geom_bodyid[state.contact.geom]].sum(axis=1)
        normals_n = state.efc_force[state.contact.efc_address]
        assert normal(state).sum() == pytest.approx(sides @ normals_n, rel=1e-9)


def test_every_number_has_a_name_a_unit_and_a_body(child):
    touch, data = child
    for quantity in QUANTITIES.values():
        other = Touch(touch.receptors, data.model, quantity, RESPONSES["linear"])
        layout = other.layout
        assert (
            len(set(layout)) == len(layout) == len(other.bodies) == other.spaces["touch"].shape[0] == len(other(data))
        )
        assert all(name.endswith(" [N]") for name in layout)
        assert [name.split()[0] for name in layout] == [data.model.body(body).name for body in other.bodies]


def test_the_points_of_a_body_are_counted():
    data = world(ball(), ball("other", "1 0 1"))
    touch = skin(data, {"ball": [BOTTOM, BOTTOM], "other": [BOTTOM]})
    assert touch.layout[2:5] == ("ball 0 world z [N]", "ball 1 world x [N]", "ball 1 world y [N]")
    assert touch.layout[6] == "other 0 world x [N]"


def test_what_is_observed_is_fresh_and_within_its_space(child):
    touch, data = child
    for state in moving(data, 10):
        sample = touch(state)
        observed = touch.observe(sample)["touch"]
        assert observed in touch.spaces["touch"]
        assert_allclose(observed, sample, rtol=1e-6)
        assert not np.shares_memory(observed, touch.observe(sample)["touch"])


def test_the_skin_moves_with_the_body(child):
    """Its points stay where they are in the frames of their bodies."""
    touch, data = child
    in_body = []
    for state in tangled(data, 3):
        positions = touch.skin_state(state).positions
        world_from_body = state.xmat[touch.receptors.bodies].reshape(-1, 3, 3)
        in_body.append(np.einsum("nji,nj->ni", world_from_body, positions - state.xpos[touch.receptors.bodies]))
    for once, later in pairwise(in_body):
        assert_allclose(later, once, atol=1e-12)
    assert_allclose(in_body[0], touch.receptors.points_m, atol=1e-12)


def test_the_state_of_the_skin_is_in_the_world_whatever_is_observed():
    states = [touch.skin_state(data) for touch, data, _ in (infant(quantity=quantity) for quantity in QUANTITIES)]
    for state in states:
        assert state.forces.any()
        assert (state.forces == states[0].forces).all()
        assert state.bodies.shape == (len(state.forces),)
        assert {"head", "hip", "left_foot"} <= set(state.bodies.tolist())


def test_a_denser_skin_feels_more():
    coarse, fine = (built(9, "mitten", "supine", density=density) for density in (0.5, 2))
    points = [len(bind(each.manifest.senses.touch, load_model(each), each).receptors.names) for each in (coarse, fine)]
    assert points[1] == pytest.approx(4 * points[0], rel=0.1)


def test_every_quantity_and_response_of_the_spec_exists():
    assert QUANTITIES.keys() == set(get_args(TouchQuantity))
    assert RESPONSES.keys() == set(get_args(TouchResponse))
