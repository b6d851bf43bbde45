"""Touch of whole infants: at rest, moving, and tangled."""

from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from typing import get_args

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.full import full_rows
from support.touch_oracle import contact_forces, points, touch_loop

import mimoc
from mimoc.bundle.model import load_model
from mimoc.components.senses.touch import TouchQuantity, TouchResponse
from mimoc.components.senses.touch.run import QUANTITIES, RESPONSES, Touch, bind

G_M_S2 = 9.81


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


@pytest.mark.full
@pytest.mark.parametrize("response", get_args(TouchResponse))
@pytest.mark.parametrize("quantity", get_args(TouchQuantity))
@pytest.mark.parametrize(
    ("age_months", "hands", "pose"),
    full_rows([(0, "mitten", "supine")], [(9, "five_finger", "sitting"), (24, "mitten", "prone")]),
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


def test_a_denser_skin_has_more_points():
    coarse, fine = (built(9, "mitten", "supine", density=density) for density in (0.5, 2))
    points = [len(bind(each.manifest.senses.touch, load_model(each), each).receptors.names) for each in (coarse, fine)]
    assert points[1] == pytest.approx(4 * points[0], rel=0.1)


def test_every_quantity_and_response_of_the_spec_exists():
    assert QUANTITIES.keys() == set(get_args(TouchQuantity))
    assert RESPONSES.keys() == set(get_args(TouchResponse))


def test_the_quantities_are_of_one_force():
    """In the body's frame, in the world's, and its part along the normal."""
    (on_body, data, _), (in_world, *_), (normal, *_) = (infant(quantity=quantity) for quantity in QUANTITIES)
    for state in tangled(data, 20):
        world_from_body = state.xmat[on_body.receptors.bodies].reshape(-1, 3, 3)
        forces, pressures = points(in_world(state)), normal(state)
        turned = np.einsum("nij,nj->ni", world_from_body, points(on_body(state)))
        assert_allclose(turned, forces, atol=1e-12 * np.abs(forces).max())
        assert ((pressures > 0) == forces.any(axis=1)).all()


def test_points_may_be_as_far_apart_as_the_spec_admits():
    """Then each part has one or few; by the spacing at two years, they are further apart than ten metres."""
    touch = built.__wrapped__(24, "mitten", "supine", spacing_cm={"right_upper_arm": 1000}).manifest.senses.touch
    assert [part.points for part in touch.skin] == [1]
    assert touch.skin[0].spacing_m > 10
