"""Each reflex in physics: a stimulus gives the response at an age inside its window, and none outside it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from support import store
from support.examiner import SENSES, Examiner

from mimoc.policies.policy import OfOne, batch_of_one
from mimoc.policies.reflexes.binding import Reflexes
from mimoc.policies.reflexes.repertoire import REFLEXES

Trace = dict[str, np.ndarray]
MAX_RAD = 0.9
"""How far an examiner tips an infant over."""


def place_on(examiner: Examiner, body: str, low, high, outward) -> np.ndarray:
    """Return the outermost skin point of a body within a box, whose sides are shares of the box around all points."""
    receptors = examiner.env.senses["touch"].receptors
    places = receptors.points_m[receptors.names == body]
    shares = (places - places.min(axis=0)) / np.ptp(places, axis=0)
    inside = places[((shares >= low) & (shares <= high)).all(axis=1)]
    return inside[np.argmax(inside @ outward)]


def press_palm(examiner):
    examiner.start("standing", 0.1, is_held=True)
    place = place_on(examiner, "right_hand", (0.3, 0, 0.4), (0.7, 1, 0.8), (0, -1, 0))
    return lambda time_s: examiner.press("right_hand", place, (0, 1, 0), 0.6)


def press_ball(examiner):
    examiner.start("standing", 0.1, is_held=True)
    place = place_on(examiner, "right_foot", (0.75, 0.2, 0), (0.95, 0.8, 1), (0, 0, -1))
    return lambda time_s: examiner.press("right_foot", place, (0, 0, 1), 0.6)


def touch_cheek(examiner):
    examiner.start()
    place = place_on(examiner, "head", (0.6, 0.5, 0.05), (0.9, 1, 0.5), (0, 1, 0))
    return lambda time_s: examiner.press("head", place, (0, -1, 0), 0.4 if 0.2 < time_s < 0.8 else 0.0)


def fall(examiner):
    examiner.start(lifted_m=0.35)
    return lambda time_s: None


def drop_head(examiner):
    """The trunk of a supine infant is held in the air, and nothing holds its head."""
    examiner.start(lifted_m=0.3)
    return lambda time_s: examiner.hold()


def turn_head(examiner):
    examiner.start()
    examiner.turn_head(0.9)
    return lambda time_s: None


def stand_on_plate(examiner):
    examiner.start("standing", 0.1, is_held=True)
    height_m = min(examiner.data.body(f"{side}_foot").xpos[2] for side in ("right", "left")) - 0.008
    return lambda time_s: examiner.put_plate(height_m)


def touch_foot_back(examiner):
    examiner.start("standing", 0.15, is_held=True)
    place = place_on(examiner, "right_foot", (0.4, 0.1, 0), (0.95, 0.9, 1), (0, 0, 1))
    return lambda time_s: examiner.press("right_foot", place, (0, 0, -1), 0.5 if 0.2 < time_s < 0.5 else 0.0)


def tip(pitch: float = 0.0, roll: float = 0.0):
    def do(examiner):
        examiner.start("sitting", 0.05, is_held=True)

        def hold(time_s):
            angle = MAX_RAD * min(1.0, max(0.0, time_s - 0.2) / 0.5)
            return examiner.hold(pitch * angle, roll * angle)

        return hold

    return do


def more(joint: str, sign: int = 1) -> Callable[[Trace, Trace], float]:
    """Return how much further a joint is turned than without reflexes at some time, in degrees."""
    return lambda moved, still: float(np.degrees((sign * (moved[joint] - still[joint])).max()))


@dataclass(frozen=True)
class Trial:
    """What is done to an infant, and what is to be seen."""

    reflex: str
    do: Callable
    seconds: float
    inside_months: float
    outside_months: float
    seen: dict[str, tuple[Callable[[Trace, Trace], float], float]]
    """Measures, and what they must exceed, in degrees."""


TRIALS = (
    Trial("palmar_grasp", press_palm, 1.0, 1, 7, {"fingers close": (more("right_fingers", -1), 20)}),
    Trial("plantar_grasp", press_ball, 1.0, 1, 13, {"toes curl": (more("right_toes", -1), 8)}),
    Trial(
        "moro",
        fall,
        0.6,
        1,
        7,
        {"elbow straightens": (more("right_elbow"), 25), "hand opens": (more("left_fingers"), 25)},
    ),
    Trial(
        "moro",
        drop_head,
        1.5,
        1,
        7,
        {
            "arm spreads": (more("right_shoulder_ad_ab"), 25),
            "elbow straightens": (more("left_elbow"), 25),
            "arm comes back": (more("right_shoulder_ad_ab", -1), 5),
        },
    ),
    Trial("tonic_neck", turn_head, 5.0, 1.5, 8, {"arm of the face's side straightens": (more("left_elbow"), 8)}),
    Trial("rooting", touch_cheek, 1.5, 1, 5, {"head turns to the touch": (more("head_swivel"), 10)}),
    Trial(
        "stepping",
        stand_on_plate,
        8.0,
        0.5,
        5,
        {"right leg lifts": (more("right_hip1", -1), 20), "left leg lifts": (more("left_hip1", -1), 20)},
    ),
    Trial("placing", touch_foot_back, 1.2, 0.5, 5, {"leg lifts": (more("right_hip1", -1), 20)}),
    Trial(
        "protective_forwards",
        tip(pitch=1.0),
        1.2,
        10,
        5,
        {"arm reaches": (more("right_shoulder_horizontal"), 20), "elbow straightens": (more("left_elbow"), 15)},
    ),
    Trial("protective_sideways", tip(roll=-1.0), 1.2, 10, 5, {"arm reaches": (more("left_shoulder_ad_ab"), 25)}),
    Trial(
        "protective_backwards", tip(pitch=-1.0), 1.2, 11, 7, {"arm reaches": (more("left_shoulder_horizontal", -1), 8)}
    ),
)


@cache
def examiner_of(age_months: float, model: str, hands: str = "mitten") -> Examiner:
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": {"hands": hands}}
    scene = {"kind": "flat", "pose": "supine"}
    return Examiner(store.built({**spec, "actuation": {"model": model}, "senses": SENSES, "scene": scene}))


def examine(trial: Trial, examiner: Examiner, policy: str) -> Trace:
    return examiner.watch(policy, trial.seconds, trial.do(examiner))


def only(reflex: str) -> Callable:
    """Return the policy that has one reflex."""
    return lambda env: OfOne(Reflexes(batch_of_one(env), reflexes={reflex: REFLEXES[reflex]}))


@pytest.mark.parametrize("model", ["muscle", "torque"])
@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: f"{trial.reflex}-{trial.do.__name__}")
def test_a_stimulus_gives_the_response_inside_the_window_of_ages(trial, model):
    examiner = examiner_of(trial.inside_months, model)
    still = examine(trial, examiner, "zero")
    moved = examine(trial, examiner, only(trial.reflex))
    seen = {what: measure(moved, still) for what, (measure, _) in trial.seen.items()}
    assert {what for what, (_, least) in trial.seen.items() if seen[what] <= least} == set()


@pytest.mark.parametrize("trial", TRIALS, ids=lambda trial: f"{trial.reflex}-{trial.do.__name__}")
def test_a_stimulus_gives_nothing_outside_the_window_of_ages(trial):
    moved = examine(trial, examiner_of(trial.outside_months, "muscle"), only(trial.reflex))
    assert moved["actions"].size
    assert not moved["actions"].any()


def test_five_fingers_close_and_servos_too():
    examiner = examiner_of(1, "torque", "five_finger")
    trial = Trial("palmar_grasp", press_palm, 1.0, 1, 7, {})
    still, moved = examine(trial, examiner, "zero"), examine(trial, examiner, only("palmar_grasp"))
    assert more("right_ff_knuckle")(moved, still) > 10
    examiner = examiner_of(1, "position")
    still, moved = examine(trial, examiner, "zero"), examine(trial, examiner, only("palmar_grasp"))
    assert more("right_fingers", -1)(moved, still) > 10


def test_the_other_hand_does_not_close():
    examiner = examiner_of(1, "muscle")
    moved = examine(TRIALS[0], examiner, only("palmar_grasp"))
    commanded = {
        actuator.name
        for actuator, action in zip(
            examiner.env.manifest.actuation.actuators, moved["actions"].max(axis=0), strict=True
        )
        if action > 0
    }
    assert commanded == {"act:right_fingers_negative"}


@pytest.mark.full
@pytest.mark.slow
def test_an_infant_that_moves_by_itself_does_not_startle_itself():
    examiner = examiner_of(3, "muscle")
    examiner.start()
    examiner.watch("general_movements+reflexes", 10.0)
    assert examiner.policy.metrics()["moro_share"] == 0
