"""What is around the infants of a world that are named: objects, toys, ribbons, and furniture to start at."""

from typing import Any

import mujoco
import numpy as np
import pytest
from support.worlds import placed

import mimoc
from mimoc.base.errors import SpecError
from mimoc.bundle.world import START, WorldBundle, load_world_model
from mimoc.compiler.variants import WorldBundleVariants
from mimoc.runtime.opening import shared_world

SITTING: dict[str, Any] = {"mimoc": 1, "name": "x", "age_months": 9, "scene": {"pose": "sitting"}}
PAIR = {"anna": SITTING, "ben": {**SITTING, "age_months": 7}}
LYING = {name: {**data, "scene": {"pose": "supine"}} for name, data in PAIR.items()}


def started(bundle: WorldBundle, keyframe: str = START) -> mujoco.MjData:
    model = load_world_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(keyframe).id)
    mujoco.mj_fwdPosition(model, data)
    return data


def apart_m(data: mujoco.MjData, one: str, other: str) -> float:
    return float(np.linalg.norm(data.body(one).xpos[:2] - data.body(other).xpos[:2]))


@pytest.mark.parametrize("who", [None, "anna", "ben"])
def test_an_object_is_placed_by_the_infant_that_it_names(who):
    ball = {"name": "ball", "at": "within reach of right_hand", **({"infant": who} if who else {})}
    data = started(placed(PAIR, {}, {}, scene={"objects": [ball]}))
    near, far = ("ben", "anna") if who == "ben" else ("anna", "ben")
    assert apart_m(data, "object_ball", f"{near}_right_hand") < 0.25 < apart_m(data, "object_ball", f"{far}_right_hand")


def test_no_object_is_placed_within_another_infant():
    """To the left of one is the other one: what is beside it keeps free of both."""
    places = [{"y_cm": 0, "x_cm": 0}, {"y_cm": 45, "x_cm": 0}]
    balls = [{"name": f"ball{n}", "at": "beside left_hand", "infant": "anna"} for n in range(3)]
    data = started(placed(PAIR, *places, scene={"objects": balls}))
    model = data.model
    bodies = model.body_rootid[model.geom_bodyid[data.contact.geom]]
    thrown = [model.body(f"object_ball{n}").id for n in range(3)]
    assert not (np.isin(bodies, thrown).any(axis=1) & (bodies > 0).all(axis=1)).any()
    assert max(data.body(body).xpos[1] for body in thrown) > 0.45  # Beyond the other one.


def test_toys_are_around_the_infant_that_they_name():
    scene = {"toys": {"count": [3, 3], "infant": "ben"}}
    bundle = placed(PAIR, {"y_cm": -200}, {"y_cm": 200}, scene=scene)
    data = started(bundle)
    assert all(apart_m(data, toy.body, "ben_hip") < 1.5 for toy in bundle.manifest.toys)


BEYOND = {"frame": "infant", "x_cm": 60, "y_cm": 0, "z_cm": 30}  # The feet of an infant on its back.
MOBILE = {"kind": "mobile", "name": "mobile", "at": BEYOND, "tied_to": "left_foot"}


def test_a_ribbon_is_tied_to_the_limb_of_the_infant_that_is_named():
    bundle = placed(LYING, {}, {}, scene={"objects": [{**MOBILE, "infant": "ben"}]})
    assert bundle.manifest.objects[0].tied_to == "ben_left_foot"
    assert bundle.infants["anna"].manifest.objects[0].tied_to == "ben_left_foot"
    data, model = started(bundle), load_world_model(bundle)
    ribbon = model.tendon(bundle.manifest.objects[0].ribbon).id
    assert data.ten_length[ribbon] == pytest.approx(model.tendon_range[ribbon, 1] - 0.005, abs=1e-4)


def test_the_leg_of_the_tied_infant_alone_moves_a_mobile():
    bundle = placed(LYING, {}, {}, scene={"objects": [{**MOBILE, "infant": "ben"}]})
    swings = {}
    for who in ("anna", "ben"):
        env = shared_world(bundle)
        env.reset(seed=0)
        rest = env.data.joint("object_mobile_cord").qpos.copy()
        names = [env.model.actuator(int(index)).name for index in env.infants[who].actuation.actuators]
        legs = np.array([name.endswith(("_hip_flex", "_knee")) for name in names])
        most = 0.0
        for step in range(100):
            actions = {name: np.zeros(env.action_space(name).shape, np.float32) for name in env.agents}
            actions[who] = (legs * (1.0 if step % 60 > 30 else -1.0)).astype(np.float32)
            env.step(actions)
            most = max(most, float(np.abs(env.data.joint("object_mobile_cord").qpos - rest).max()))
        swings[who] = most
        env.close()
    assert swings["ben"] > 10 * swings["anna"]


def test_poses_in_which_a_ribbon_is_too_short_or_an_object_inside_of_an_infant_are_left_out():
    bundle = placed(LYING, {}, {}, scene={"objects": [{**MOBILE, "infant": "ben"}]})
    kept = {name: infant.manifest.poses for name, infant in bundle.infants.items()}
    assert "anna_standing" in kept["anna"]
    assert "ben_standing" not in kept["ben"]
    model = load_world_model(bundle)
    keys = {model.key(number).name for number in range(model.nkey)}
    assert keys == {START, *kept["anna"], *kept["ben"]}


def test_an_object_that_would_start_inside_of_any_infant_is_refused_at_its_place():
    objects = [{"name": "block", "shape": "box", "motion": "fixed", "at": {"x_cm": 0, "y_cm": 60, "z_cm": 5}}]
    with pytest.raises(SpecError, match=r"scene\.objects\[0\]\.at: it would start inside of 'ben_"):
        placed(PAIR, {"y_cm": -60}, {"y_cm": 60}, scene={"objects": objects})


def test_furniture_comes_to_the_infant_that_starts_there():
    bundle = placed(PAIR, {"start_at": "seat"}, {}, scene={"objects": [{"kind": "seat", "name": "seat"}]})
    data = started(bundle)
    assert apart_m(data, "object_seat", "anna_hip") < 0.2 < apart_m(data, "object_seat", "ben_hip")
    assert bundle.infants["anna"].manifest.poses == ("anna_sitting",)
    assert len(bundle.infants["ben"].manifest.poses) == 4


def test_furniture_at_a_place_takes_the_infant_there_at_all_ages(tmp_path):
    seat = {"kind": "seat", "name": "seat", "at": {"x_cm": 100, "y_cm": 50}, "yaw_deg": 90}
    bundle = placed(PAIR, {"start_at": "seat"}, {}, scene={"objects": [seat]})
    read = mimoc.read_world_bundle(mimoc.write_bundle(bundle, tmp_path / "two"))
    for one in (read, WorldBundleVariants(read)({"anna": 10}, 0).bundle):
        assert started(one).body("anna_hip").xpos[:2] == pytest.approx((1.0, 0.5), abs=0.15)


@pytest.mark.parametrize(
    ("entries", "scene", "message"),
    [
        ([{"start_at": "seet"}, {}], {}, r"infants\[0\]\.start_at: there is no object 'seet'; did you mean 'seat'"),
        ([{"start_at": "seat"}, {"start_at": "seat"}], {}, r"infants\[1\]\.start_at: another infant starts at 'seat'"),
        ([{"start_at": "seat", "x_cm": 3}, {}], {"at": {"x_cm": 0}}, r"infants\[0\]\.x_cm: 'seat' has a place of its"),
        ([{}, {}], {"infant": "bem"}, r"objects\[0\]\.infant: there is no infant 'bem'; did you mean 'ben'"),
    ],
)
def test_names_that_are_not_there_are_one_line(entries, scene, message):
    with pytest.raises(SpecError, match=message) as refusal:
        placed(PAIR, *entries, scene={"objects": [{"kind": "seat", "name": "seat", **scene}]})
    assert len(refusal.value.problems) == 1


def test_a_single_infant_cannot_name_others():
    with pytest.raises(SpecError, match=r"scene\.toys\.infant: 'ben' is another infant, and only a world has several"):
        mimoc.InfantSpec.model_validate({**SITTING, "scene": {"kind": "room", "toys": {"infant": "ben"}}})


def test_objects_move_to_the_hands_of_the_infants_that_are_named():
    env = shared_world(placed(PAIR, {}, {}, scene={"objects": [{"name": "ball", "at": {"x_cm": 60, "y_cm": 0}}]}))
    for options, hand in (
        ({"objects": {"ball": "within reach of ben_left_hand"}}, "ben_left_hand"),
        ({"ben": {"objects": {"ball": "within reach of left_hand"}}}, "ben_left_hand"),
        ({"objects": {"ball": "within reach of left_hand"}}, "anna_left_hand"),
    ):
        env.reset(seed=0, options=options)
        assert apart_m(env.data, "object_ball", hand) < 0.2
    env.close()
