"""A mobile over a newborn: it is seen, and the foot that its ribbon is tied to makes it swing and ring."""

from contextlib import closing
from pathlib import Path

import mujoco
import numpy as np
import pytest
from support import store
from support.scenes_of_objects import built_with, fastest_m_s, spec_with, started

import mimoc
from mimoc.base.errors import SpecError
from mimoc.policies.named import policy_of

CONFIG = Path(__file__).parents[3] / "configs" / "mobile.yaml"
MOBILE = {"name": "mobile", "kind": "mobile", "above": "chest", "height_cm": 25}
TIED = {**MOBILE, "tied_to": "right_foot"}


def hung(**keys):
    return built_with({**MOBILE, **keys}, age_months=0)


def test_its_lowest_point_is_where_the_spec_says_and_it_hangs_still():
    bundle = hung()
    model, data = started(bundle)
    own = [geom for geom in range(model.ngeom) if model.geom(geom).name in bundle.manifest.objects[0].geoms]
    lows = [data.geom_xpos[geom][2] - model.geom_rbound[geom] for geom in own]
    chest = np.array([data.geom_xpos[model.geom("ub1").id][2]])
    assert min(lows) > chest.max() + 0.2
    for _ in range(400):
        mujoco.mj_step(model, data)
    assert fastest_m_s(bundle, model, data) < 1e-3
    assert not data.warning.number.any()


def test_a_struck_figure_swings_and_strikes_the_bell():
    bundle = hung()
    model, data = started(bundle)
    (bell,) = bundle.manifest.objects[0].bells
    address, rung = model.joint("object_mobile_figure1").dofadr[0], 0
    data.qvel[address : address + 3] = (10.0, 0.0, 0.0)
    for _ in range(400):
        mujoco.mj_step(model, data)
        rung += any(model.geom(bell).id in contact.geom for contact in data.contact)
    assert rung > 0


def test_the_ribbon_is_as_long_as_its_way_and_its_slack_and_only_pulls():
    bundle = built_with({**TIED, "slack_cm": 3}, age_months=0)
    (entry,) = bundle.manifest.objects
    model, data = started(bundle)
    ribbon = model.tendon(entry.ribbon).id
    assert model.tendon_range[ribbon, 1] - data.ten_length[ribbon] == pytest.approx(0.03, abs=1e-6)
    assert entry.tied_to == "right_foot"
    free, _ = started(hung())
    assert free.ntendon == model.ntendon - 1


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_kick_of_the_tied_foot_swings_it_and_one_of_the_other_foot_does_not(side):
    """A kick stretches hip and knee of one leg for a fifth of a second."""
    spec = {**spec_with(TIED, age_months=0), "actuation": {"model": "torque"}}
    bundle = store.built(spec)
    model, data = started(bundle)
    fastest = 0.0
    for step in range(300):
        for joint in ("hip_flex", "knee"):
            data.ctrl[model.actuator(f"act:{side}_{joint}").id] = step < 40
        mujoco.mj_step(model, data)
        fastest = max(fastest, fastest_m_s(bundle, model, data))
    assert (fastest > 0.05) == (side == "right"), fastest
    assert not data.warning.number.any()


@pytest.mark.full
@pytest.mark.slow
def test_general_movements_of_a_newborn_swing_it():
    with closing(mimoc.make(CONFIG)) as env:
        observation, _ = env.reset(seed=0)
        infant, generator = env.unwrapped, np.random.default_rng(0)
        policy, speeds = policy_of(infant, "general_movements"), []
        for _ in range(1000):
            observation, *_ = env.step(policy(generator, observation))
            speeds.append(fastest_m_s(infant.bundle, infant.model, infant.data))
        assert speeds[0] < 0.01
        assert max(speeds) > 0.2
        assert not infant.data.warning.number.any()


def test_a_newborn_sees_it():
    """In the picture from each eye there are colours that are not there without the mobile."""
    spec = mimoc.load_spec(CONFIG)
    seen = []
    for objects in (spec.scene.objects, ()):
        infant = spec.with_(scene={"objects": [*objects]}, senses={"vision": {"acuity": "off"}})
        with closing(mimoc.make(infant)) as env:
            observation, _ = env.reset(seed=0)
            seen.append({name: observation[name].astype(int) for name in ("eye_left", "eye_right")})
    for eye in seen[0]:
        differs = np.abs(seen[0][eye] - seen[1][eye]).max(axis=2) > 60
        assert differs.mean() > 0.01, eye
        vivid = np.ptp(seen[0][eye], axis=2) > 100
        assert vivid.sum() > 5, eye


def test_an_infant_without_the_limb_cannot_be_tied():
    spec = spec_with(TIED)
    spec["body"]["remove"] = ["right_foot"]
    with pytest.raises(SpecError, match=r"objects\[0\].tied_to: this infant has no right_foot; tie it to another limb"):
        mimoc.build(mimoc.InfantSpec.model_validate(spec))


def test_poses_in_which_the_ribbon_is_too_short_are_left_out():
    bundle = built_with(TIED, age_months=12)
    model, data = started(bundle)
    ribbon = model.tendon(bundle.manifest.objects[0].ribbon).id
    for pose in bundle.manifest.poses:
        _, data = started(bundle, pose)
        assert data.ten_length[ribbon] <= model.tendon_range[ribbon, 1] + 1e-5, pose
