"""Pain: of what presses harder than a threshold, and of joints that are forced beyond their range."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from support import store
from support.full import full_but

import mimoc
from mimoc.body.poses import SLUMP_MONTHS
from mimoc.compiler.explain import entries_of
from mimoc.components.senses.pain import PainEntry, PainRegion, threshold_kpa
from mimoc.components.senses.pain.run import Fading, bind
from mimoc.runtime.contract import check_term
from mimoc.runtime.noise import NoiseStreams, SignalNoise, processing_of
from mimoc.runtime.worlds import NUMPY, worlds_of_one
from mimoc.schema.senses import NoiseEntry

PRESSED = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="foot" pos="0 0 .02"><freejoint/><geom size=".02" mass="1"/></body>
    <body name="leg" pos="1 0 1">
      <joint name="knee" range="-60 0" limited="true"/><geom size=".02" mass=".1"/>
    </body>
  </worldbody>
</mujoco>
"""
ENTRY = PainEntry(
    regions=(
        PainRegion(name="foot", bodies=("foot",), threshold_n=20.0),
        PainRegion(name="leg", bodies=("leg",), joints=("knee",), threshold_n=60.0),
    ),
    strain_deg=5.0,
    decay_ms=1000.0,
)


def pressed(force_n: float, knee_deg: float = -30.0):
    """Return model, data and sense of a foot that is pressed on the floor, and a leg that is bent."""
    model = mujoco.MjModel.from_xml_string(PRESSED)
    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    data = mujoco.MjData(model)
    data.xfrc_applied[model.body("foot").id, 2] = -force_n
    for _ in range(2000):
        mujoco.mj_step(model, data)
    data.joint("knee").qpos[0] = np.deg2rad(knee_deg)
    mujoco.mj_kinematics(model, data)
    return model, data, bind(ENTRY, model, bundle=None)


@pytest.mark.parametrize("force_n", [5.0, 19.0, 21.0, 40.0, 200.0])
def test_pressure_hurts_as_far_as_it_exceeds_the_threshold(force_n):
    _, data, sense = pressed(force_n)
    assert sense(data) == pytest.approx([max(force_n / 20 - 1, 0), 0], rel=0.01)


@pytest.mark.parametrize(("knee_deg", "pain"), [(-30, 0), (-60, 0), (4.9, 0), (10, 1), (-65.1, 0.02), (-75, 2)])
def test_a_joint_hurts_as_far_as_it_is_forced_beyond_its_range(knee_deg, pain):
    _, data, sense = pressed(0.0, knee_deg)
    assert sense(data) == pytest.approx([0, pain], abs=1e-6)


@pytest.mark.extras
def test_pain_is_a_term():
    model, data, sense = pressed(50.0)
    check_term(sense.term, model)
    assert worlds_of_one(data).loads(sense.term.region_of_geom)[0, 0] == pytest.approx(50, rel=0.01)


def test_nothing_presses_where_nothing_touches():
    model, _, sense = pressed(0.0)
    data = mujoco.MjData(model)
    data.qpos[2] = 1
    mujoco.mj_forward(model, data)
    assert worlds_of_one(data).loads(sense.term.region_of_geom).tolist() == [[0, 0]]


@given(st.floats(0, 5), st.floats(0.1, 5), st.floats(0, 3))
def test_pain_fades_unless_there_is_more(first, time_constant_s, later_s):
    fading = Fading(np.array([[time_constant_s]]))
    _, state = fading(NUMPY, np.inf, np.array([[first]]), None)
    felt, _ = fading(NUMPY, later_s, np.array([[1.0]]), state)
    assert felt[0, 0] == pytest.approx(max(1.0, first * np.exp(-later_s / time_constant_s)))


@given(st.floats(0, 24), st.floats(0, 24))
def test_the_older_bear_more(one, other):
    young, old = (threshold_kpa(age) for age in sorted((one, other)))
    assert 250 < young <= old < 550


def infant(age_months: float, pose: str, **keys) -> mimoc.InfantEnv:
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "scene": {"kind": "flat", "pose": pose}}
    return mimoc.InfantEnv(store.built({**spec, "senses": {"pain": {}}, **keys}))


@pytest.mark.parametrize("pose", ["supine", "prone"])
@pytest.mark.parametrize("age_months", full_but([0, 9], [3, 6, 12, 18, 24]))
@pytest.mark.parametrize("development", ["maturing", "published"])
def test_an_infant_that_lies_still_feels_no_pain(age_months, pose, development):
    env = infant(age_months, pose, development=development)
    env.reset(seed=0)
    worst = np.max([env.step(np.zeros(env.action_space.shape))[0]["pain"] for _ in range(100)], axis=0)
    assert (worst == 0).all()


@pytest.mark.parametrize("age_months", full_but([0, 9], [3, 6, 12, 18, 24]))
def test_an_infant_that_falls_on_its_head_from_sitting_feels_it_there(age_months):
    """It is pushed backwards, harder if it slumps; what it felt is gone some seconds later."""
    env = infant(age_months, "sitting")
    env.reset(seed=0)
    env.data.qvel[0] = -3.0 if age_months < SLUMP_MONTHS[1] else -2.0
    head = env.layout("pain").index("head [thresholds]")
    felt = [env.step(np.zeros(env.action_space.shape))[0]["pain"][head] for _ in range(900)]
    assert max(felt) > 1
    assert felt[-1] < 0.01 * max(felt) + 1e-6


def test_regions_are_all_of_the_body_each_part_once():
    env = infant(9, "supine", body={"hands": "five_finger"})
    regions = env.manifest.senses.pain.regions
    parts = [body for region in regions for body in region.bodies]
    own = env.model.body_rootid == env.model.body(env.manifest.root_body).id
    assert sorted(parts) == sorted(env.model.body(index).name for index in np.flatnonzero(own))
    assert {region.name for region in regions} == {
        "head",
        "trunk",
        *(f"{side}_{part}" for side in ("left", "right") for part in ("arm", "hand", "leg", "foot")),
    }


def test_thresholds_are_explained_and_can_be_those_of_adults():
    spec = {"mimoc": 1, "name": "x", "age_months": 0, "senses": {"pain": {"threshold": "adult", "area_cm2": 1}}}
    entries = entries_of(mimoc.build(mimoc.InfantSpec.model_validate(spec)))
    sole, leg = (entries[f"pain.left_{region}.threshold"] for region in ("foot", "leg"))
    assert sole["value"] == pytest.approx(threshold_kpa(12) / 10)
    assert leg["value"] == pytest.approx(3 * sole["value"])
    assert sole["from"] == ["spec.senses.pain.threshold", "spec.senses.pain.area_cm2"]


def test_what_it_felt_is_in_its_state():
    _, data, sense = pressed(60.0)
    organ = SignalNoise(processing_of("pain", sense, NoiseEntry()), "pain", NoiseStreams(0))
    assert organ.at(0.0, sense(data))[0] == pytest.approx(2, rel=0.01)
    assert organ.at(1.0, np.zeros(2))[0] == pytest.approx(2 / np.e, rel=0.01)
