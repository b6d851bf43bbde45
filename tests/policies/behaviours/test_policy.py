"""Behaviours of an infant: together, at the ages at which they succeed, and where they cannot be done."""

import itertools
from typing import Any

import numpy as np
import pytest
from support.full import full_rows

import mimoc
from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.behaviours.behaviour import Behaviour
from mimoc.policies.named import policy_of
from mimoc.policies.rollout import Run
from mimoc.schema.kinds import POLICIES, PolicyKind

TEXTS = {"look_at": "look_at(0.5, 0.2, 0.3)", "reach_for": "reach_for(0.15, -0.1, 0.25, right)"}
BEHAVIOURS = [TEXTS.get(name, name) for name in POLICIES if POLICIES[name].is_behaviour and name != "look_around"]


def infant(age_months=9.0, scene=None, **keys) -> Any:
    spec: Any = {"mimoc": 1, "name": "kim", "age_months": age_months, "senses": {"vestibular": {}}, **keys}
    return mimoc.make(mimoc.InfantSpec(**{**spec, "scene": {"pose": "sitting", **(scene or {})}})).unwrapped


def ran(env, policy, seconds) -> Any:
    run = Run(env, policy, seed=0)
    for _ in range(round(1000 * seconds / env.manifest.step_ms)):
        run.step()
    return run


def ensemble_of(run) -> Any:
    return run.policies[""]._ensemble


@pytest.fixture(scope="module")
def nine():
    return infant()


@pytest.mark.parametrize(("age_months", "held"), [(3, False), (6, True)])
def test_infants_sit_at_six_months_and_fall_at_three(age_months, held):
    metrics = ran(infant(age_months), "sit", 10.0).summary().metrics
    assert metrics["held_share"] == held
    assert metrics["held_s"] == 10.0 if held else metrics["held_s"] < 1.0


@pytest.mark.full
@pytest.mark.parametrize(
    ("policy", "young", "old"), [("prone", 1, 4), ("hands_and_knees", 4, 8), ("stand", 5, 12), ("hold", 0, 9)]
)
def test_a_posture_is_lost_by_the_young_and_kept_by_the_old(policy, young, old):
    assert ran(infant(young), policy, 3.0).summary().metrics["held_s"] < 3.0
    assert ran(infant(old), policy, 3.0).summary().metrics["held_share"] == 1.0


@pytest.mark.parametrize(
    ("policy", "model"),
    full_rows(
        [*((policy, "torque") for policy in BEHAVIOURS), ("hold", "muscle"), ("kick", "position")],
        itertools.product(BEHAVIOURS, ("muscle", "position")),
    ),
)
def test_every_behaviour_acts_within_the_range_and_twice_the_same(policy, model):
    env = infant(actuation={"model": model})
    first, second = (ran(env, policy, 0.1) for _ in range(2))
    assert first.env.data.qpos.tobytes() == second.env.data.qpos.tobytes()
    metrics = first.summary().metrics
    assert metrics
    assert np.isfinite(list(metrics.values())).all()
    observation, _ = env.reset(seed=0)
    action = policy_of(env, policy)(np.random.default_rng(0), observation)
    assert (action >= env.actuation.low).all()
    assert (action <= env.actuation.high).all()
    assert action.dtype == np.float32


def test_of_a_sum_each_joint_goes_where_the_behaviour_that_moves_it_says(nine):
    """Whatever the order; a posture of the whole body moves the others."""
    parts = ["sit", TEXTS["look_at"], TEXTS["reach_for"]]
    proposals = []
    for order in itertools.permutations(parts):
        run = Run(nine, "+".join(order), seed=0)
        run.policies[""]._chance.generator = np.random.default_rng(0)
        ensemble = ensemble_of(run)
        whole, *others = sorted(ensemble.behaviours, key=lambda item: not item.is_whole)
        proposed, expected = ensemble.proposed(nine.data, 0.0), whole.targets(nine.data, 0.0).copy()
        for other in others:
            expected[other.joints] = other.targets(nine.data, 0.0)
        assert proposed == pytest.approx(expected)
        proposals.append(proposed)
    assert all(proposed == pytest.approx(proposals[0]) for proposed in proposals)


def test_joints_that_nothing_moves_get_no_commands(nine):
    observation, _ = nine.reset(seed=0)
    action = policy_of(nine, TEXTS["look_at"])(np.random.default_rng(0), observation)
    moved = {name for group in ("neck", "eyes") for name in nine.manifest.anatomy.groups[group]}
    still = [actuator.joint not in moved for actuator in nine.manifest.actuation.actuators if actuator.commanded]
    assert not action[still].any()
    assert action.any()


def test_other_policies_add_their_commands(nine):
    observation, _ = nine.reset(seed=0)
    alone, summed = (policy_of(nine, text)(np.random.default_rng(0), observation) for text in ("sit", "sit+zero"))
    assert summed == pytest.approx(alone)


def test_an_episode_begins_in_the_posture_where_the_infant_is_and_faces():
    env = infant(10, {"kind": "room", "seed": 7, "pose": "supine"})
    env.reset(seed=0)
    place_m, leftward = env.data.body("hip").xpos[:2].copy(), env.data.body("hip").xmat.reshape(3, 3)[:, 1].copy()
    run = Run(env, "sit", seed=0)
    assert env.steps == 0
    assert env.data.body("hip").xpos[:2] == pytest.approx(place_m)
    assert env.data.body("hip").xmat.reshape(3, 3)[:, 1] == pytest.approx(leftward, abs=1e-6)
    assert env.data.body("chest").xmat[8] > 0.8
    run.step()
    assert run.summary().metrics["held_share"] == 1.0


@pytest.mark.parametrize("posture", ["sit", "prone", "hands_and_knees", "stand"])
def test_what_bears_nothing_is_never_still_unless_it_is_told_to(nine, posture):
    """Within a second; the same seed gives the same movements."""

    def movements(policy):
        run = Run(nine, policy, seed=0)
        (behaviour,) = ensemble_of(run).behaviours
        return np.array([(run.step(), behaviour.targets(nine.data, 0.0).copy())[1] for _ in range(30)])

    moved, again, still = map(movements, (posture, posture, f"{posture}(still)"))
    assert np.array_equal(moved, again)
    assert np.ptp(still, axis=0).max() == 0
    is_moved = np.ptp(moved, axis=0) > 0
    names = ensemble_of(Run(nine, posture, seed=0))._subject.infant.joint_names
    assert is_moved[names.index("head_swivel")]
    assert not is_moved[names.index("left_hip1")]


@pytest.mark.parametrize(("age_months", "apart", "is_high"), [(9, 1.5, True), (12, 1.5, True), (18, 1.0, False)])
def test_new_walkers_stand_with_their_hands_up_and_their_feet_apart(age_months, apart, is_high):
    env = infant(age_months)
    Run(env, "stand(still)", seed=0)
    places_m = {part: env.data.body(part).xpos for part in ("left_hand", "left_upper_arm", "left_foot", "right_foot")}
    hips_m = [env.data.body(f"{side}_upper_leg").xpos for side in ("left", "right")]
    feet_m = np.linalg.norm(places_m["left_foot"] - places_m["right_foot"])
    assert feet_m == pytest.approx(apart * np.linalg.norm(hips_m[0] - hips_m[1]), rel=0.04)
    assert (places_m["left_hand"][2] > places_m["left_upper_arm"][2]) == is_high


def test_an_infant_in_a_seat_stays_in_it(nine):
    env = infant(scene={"held": ["hip"]})
    before = env.data.qpos[:7].copy()
    ran(env, "sit", 0.5)
    assert env.data.qpos[:7] == pytest.approx(before, abs=0.01)


def test_held_parts_that_keep_an_infant_out_of_a_posture_are_told():
    with pytest.raises(PolicyError, match="'stand' cannot begin where held parts or locked joints are"):
        Run(infant(scene={"held": ["hip"]}), "stand", seed=0)


def test_commands_that_are_late_are_foreseen():
    """The forward model predicts over the delay of commands, so that an infant sits as well."""
    assert ran(infant(delays={"motor_ms": 40}), "sit", 4.0).summary().metrics["held_share"] == 1.0


LATE: Any = {"delays": {"preset": "physiological"}}
STEPS_MS = (5, 10, 20)


def palm_errors_m(env, seconds=3.0):
    """Return how far the right palm is from a place above the shoulder in the last half second of a reach."""
    env.reset(seed=0)
    shoulder, elbow, hand = (env.data.body(f"right_{part}").xpos.copy() for part in ("upper_arm", "lower_arm", "hand"))
    arm_m = np.linalg.norm(elbow - shoulder) + np.linalg.norm(hand - elbow)
    place_m, errors_m = (shoulder + np.array([0.05, 0.0, 0.7 * arm_m])).round(3), list[float]()
    run = Run(env, "hold+reach_for({}, {}, {}, right, truth)".format(*place_m), seed=0)
    for _ in range(round(1000 * seconds / env.manifest.step_ms)):
        run.step()
        errors_m.append(float(np.linalg.norm(env.data.body("right_hand").xipos - place_m)))
    return errors_m[-round(500 / env.manifest.step_ms) :]


@pytest.mark.parametrize(
    ("age_months", "step_ms"),
    full_rows([(4, 20), (12, 10), (24, 5)], itertools.product((4, 6, 9, 12, 18, 24), STEPS_MS)),
)
def test_a_hand_arrives_under_the_delays_of_its_age(age_months, step_ms):
    env = infant(age_months, {"pose": "supine"}, control={"step_ms": step_ms}, **LATE)
    assert max(palm_errors_m(env)) < 0.01


@pytest.mark.parametrize("region", ["right_arm", "right_hand", "legs"])
def test_a_hand_arrives_if_commands_to_one_part_take_longer(region):
    env = infant(12, {"pose": "supine"}, impairments={"delay": {region: 3}}, **LATE)
    assert max(palm_errors_m(env)) < 0.01


@pytest.mark.parametrize(("age_months", "step_ms"), full_rows([(6, 10), (7, 20)], itertools.product((6, 7), STEPS_MS)))
def test_infants_of_six_and_seven_months_sit_under_the_delays_of_their_age(age_months, step_ms):
    run = ran(infant(age_months, control={"step_ms": step_ms}, **LATE), "sit", 10.0)
    assert run.summary().metrics["held_share"] == 1.0


def test_what_is_foreseen_comes_true_for_each_joint_after_its_own_delay():
    """Commands take 20 ms to the arms and 30 to the legs: two and three control steps.

    In between, arms have the mean of what was foreseen of them, so that of legs all but that is known.
    """
    env = infant(12, **LATE)
    run, asked = Run(env, "sit", seed=0), []
    (sit,) = ensemble_of(run).behaviours
    targets = sit.targets

    def recorded(ahead, time_s):
        asked.append(ahead.qpos.copy())
        return targets(ahead, time_s)

    sit.targets = recorded
    seen = []
    for _ in range(30):
        seen.append(env.data.qpos.copy())
        run.step()
    arm, leg = (env.model.joint(f"robot:left_{name}").qposadr[0] for name in ("elbow", "knee"))
    in_20_ms, in_30_ms = np.array(asked[::2]), np.array(asked[1::2])
    assert np.ptp(np.array(seen)[:, [arm, leg]], axis=0).min() > 3e-3
    assert in_20_ms[:-2, arm] == pytest.approx(np.array(seen)[2:, arm], abs=1e-6)
    assert in_30_ms[:-3, leg] == pytest.approx(np.array(seen)[3:, leg], abs=3e-4)


def test_a_hand_comes_to_a_place_and_the_eyes_to_another(nine):
    metrics = ran(nine, "sit+look_at(0.5, 0.3, 0.3)+reach_for(0.15, -0.1, 0.25)", 2.0).summary().metrics
    assert metrics["reached_s"] < 2.0
    assert metrics["gaze_error_deg"] < 5.0
    assert metrics["held_share"] == 1.0


@pytest.mark.parametrize(("place", "side"), [("(0.2, -0.3, 0.2)", "right"), ("(0.2, 0.3, 0.2)", "left")])
def test_the_nearest_hand_reaches(nine, place, side):
    assert ensemble_of(Run(nine, f"sit+reach_for({place})", seed=0)).behaviours[1]._arm.side == side


def test_toy_is_the_nearest_toy_and_a_name_the_nearest_of_that_name():
    env = infant(scene={"toys": {"count": [3, 3]}})
    run = Run(env, "sit+look_at(toy)", seed=0)
    look, eyes_m = ensemble_of(run).behaviours[1], env.data.cam_xpos.mean(axis=0)
    distances = {toy.body: np.linalg.norm(env.data.body(toy.body).xipos - eyes_m) for toy in env.manifest.toys}
    nearest = min(distances, key=lambda body: distances[body])
    assert env.model.body(look._target.bodies[0]).name == nearest
    assert policy_of(env, f"look_at({env.manifest.toys[0].object})")


def test_only_the_leg_that_is_named_kicks():
    env = infant(3)
    run = Run(env, "kick(left, rate_per_min=30)", seed=0)
    hips = [env.model.joint(f"robot:{side}_hip1").qposadr[0] for side in ("left", "right")]
    angles = []
    for _ in range(200):
        run.step()
        angles.append(env.data.qpos[hips].copy())
    left_rad, right_rad = np.ptp(angles, axis=0)
    assert left_rad > 2 * right_rad
    assert run.summary().metrics["kick_hip_deg"] == pytest.approx(np.degrees(left_rad), abs=3.0)


def test_metrics_are_means_over_episodes(nine):
    run = Run(nine, lambda env: _short(policy_of(env, "sit")), seed=0)
    for _ in range(25):
        run.step()
    metrics = run.summary().metrics
    assert metrics["held_s"] == pytest.approx((0.1 + 0.1 + 0.05) / 3)
    assert metrics["held_share"] == 1.0


def _short(policy):
    policy.steps_per_episode = 10
    return policy


@pytest.mark.parametrize(
    ("policy", "error", "says"),
    [
        ("sit+stand", PolicyError, "'sit' and 'stand' both are postures of the whole body; choose one of them"),
        ("look_at(head)+look_at(hip)", PolicyError, "'look_at' and 'look_at_2' both move"),
        ("look_at(toy)", PolicyError, "there is no toy in this scene; add scene.toys"),
        ("look_at(heads)", UnknownNameError, "did you mean 'head'"),
        ("reach_for(head, up)", UnknownNameError, "'up' is not a hand that can reach; choose from left, right"),
        ("kick(third)", UnknownNameError, "is not a leg that can kick; choose from both, left, right"),
        ("sit(lean=7)", PolicyError, "give a number from 0.1 to 0.6"),
        (
            "sit(lean=0.3, straight)",
            PolicyError,
            "'sit' does not take 'straight'; it takes still, knees_deg=-60, lean=0.3",
        ),
    ],
)
def test_what_does_not_go_is_said(nine, policy, error, says):
    with pytest.raises(error) as caught:
        Run(nine, policy, seed=0)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("removed", "policy"),
    [
        (["right_foot"], "sit"),
        (["left_foot"], "stand"),
        (["right_hand"], "hands_and_knees"),
        (["left_eye", "right_eye"], TEXTS["look_at"]),
        (["right_hand"], TEXTS["reach_for"]),
        (["left_upper_leg"], "kick(left)"),
        (["left_lower_arm"], "prone"),
    ],
)
def test_parts_that_are_missing_are_named(removed, policy):
    with pytest.raises(PolicyError, match="which this infant lacks"):
        policy_of(infant(body={"remove": removed}), policy)


def test_many_infants_behave_as_each_alone_does(nine):
    envs = mimoc.make_vec(nine.bundle, num_envs=2, autoreset_mode="Disabled")
    policy = mimoc.policy_vec("sit+look_at(0.5, 0.2, 0.3)+zero", envs)
    generators = [np.random.default_rng(seed) for seed in range(2)]
    observations, _ = envs.reset(seed=0)
    for _ in range(5):
        observations, *_ = envs.step(policy(generators, observations))
    alone = ran(nine, "sit+look_at(0.5, 0.2, 0.3)+zero", 0.05)
    assert envs.infants[0].data.qpos == pytest.approx(alone.env.data.qpos, abs=1e-9)
    assert envs.infants[1].data.qpos != pytest.approx(alone.env.data.qpos, abs=1e-9)  # It moves by its own chances.
    envs.close()


class Nod(Behaviour):
    """Nods."""

    def __init__(self, subject):
        self.joints = subject.moved_by(("neck",))

    def targets(self, ahead, time_s):
        return np.full(len(self.joints), 0.3 * np.sin(6 * time_s))


def test_a_behaviour_from_outside_goes_with_the_others(nine):
    mimoc.register(PolicyKind("nod", "nods", lambda subject: Nod(subject), is_behaviour=True))
    try:
        assert ran(nine, "sit+nod", 1.0).summary().metrics["held_share"] == 1.0
    finally:
        POLICIES.remove("nod")


@pytest.mark.full
@pytest.mark.parametrize(("vergence", "share"), [("off", 1.0), (3, 0.0), (4, 0.5)])
def test_eyes_converge_on_what_is_near_as_far_as_they_are_mature(vergence, share):
    env = infant(9, senses={"vision": {"width_px": 8, "height_px": 8, "vergence": vergence}})
    run, place_m, apart_deg = Run(env, "sit+look_at(0.45, 0, 0.35)", seed=0), (0.45, 0, 0.35), []
    cameras = [env.data.camera(f"eye_{side}") for side in ("left", "right")]
    for _ in range(200):
        run.step()
        lines = [-camera.xmat.reshape(3, 3)[:, 2] for camera in cameras]
        wanted = [(place_m - camera.xpos) / np.linalg.norm(place_m - camera.xpos) for camera in cameras]
        apart_deg.append([np.degrees(np.arccos(min(a @ b, 1.0))) for a, b in (lines, wanted)])
    turned_deg, needed_deg = np.mean(apart_deg[100:], axis=0)
    assert needed_deg > 5
    assert turned_deg == pytest.approx(share * needed_deg, abs=0.6)
    env.close()
