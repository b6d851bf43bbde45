"""Quantities: one record for each thing that is measured, with its only name, label and unit."""

from collections.abc import Mapping
from functools import partial

from mimoc.base.kinds import Registry
from mimoc.base.movement_quantities import CORE, DETAILS, JOINTS, OF_MOVEMENT
from mimoc.base.quantity import Quantity

_of_child = partial(Quantity, over="child", steps=("build", "check", "milestones", "run", "train", "python"))

LENGTH = _of_child("length_cm", "Length", "cm", "length from crown to sole")
WEIGHT = _of_child("mass_kg", "Weight", "kg", "mass of the whole body", field="weight_kg")
HEAD = _of_child("head_circumference_cm", "Head circumference", "cm", "largest circumference of the head")
ARM = _of_child("arm_circumference_cm", "Upper-arm circumference", "cm", "circumference at mid upper arm")
AGE = Quantity("age_months", "Age", "months", "age since birth", over="child", steps=())

CHILD = (LENGTH, WEIGHT, HEAD, ARM)
INDICATORS = {quantity.key: quantity for quantity in CHILD}
"""Quantities by the name of WHO's indicator, which is also the field of a manifest's child."""

# Columns of tables that show nothing else.
PART_MASS = Quantity("mass_g", "Mass", "g")
BODY_SHARE = Quantity("share_of_body", "Share of the body", "%")
PEAK_TORQUE = Quantity("torque_nm", "Peak torque", "N m")
JOINT_RANGE = Quantity("range_deg", "Range", "°")
MEASURED = Quantity("measured_cm", "This infant", "cm")
AVERAGE = Quantity("average_cm", "Average child", "cm")
DIFFERENCE = Quantity("difference", "Difference", "%")
TOY_SIZE = Quantity("size_cm", "Longest side", "cm")
TOY_MASS = Quantity("weight_g", "Weight", "g")
FROM_AGE = Quantity("from_months", "From", "months")
MEAN_AGE = Quantity("mean_months", "Mean", "months")
JOB_TIME = Quantity("job_s", "A job", "s")
TIME_LEFT = Quantity("rest_h", "The rest", "h")
JOB_SIZE = Quantity("job_kb", "A job", "kB")

_LABELS = {
    "prone_head": "Head kept up while prone",
    "half_squat": "Half squat kept",
    "arm_out": "Arm held out",
    "no_head_lag": "No head lag",
    "sit": "Sitting",
    "hands_and_knees": "Keeping on hands and knees",
    "pull_to_stand": "Rising to stand, held",
    "stand": "Standing alone",
    "leg_lift": "Legs lifted while supine",
    "roll_over": "Rolling over",
    "supine_head": "Head lifted while supine",
    "rocking": "Rocking on hands and knees",
}

MILESTONE_AGES: Mapping[str, Quantity] = {
    trial: Quantity(
        f"{trial}_months",
        label,
        "months",
        f"age from which on the trial `{trial}` succeeds; none if it does not by 24 months",
        over="milestone",
        steps=("milestones",),
        limits=(0.0, 24.0),
    )
    for trial, label in _LABELS.items()
}
"""By the name of the trial."""

_of_poses = partial(Quantity, over="pose", steps=("check",))

STABLE = _of_poses(
    "stable", "Simulation stayed stable", "", "whether it did in all trials", reduce="all", field="passed"
)
ENERGY = _of_poses("energy_j_per_kg", "Kinetic energy", "J/kg", "largest of all trials, per body mass", reduce="max")
BEYOND_LIMITS = _of_poses("beyond_deg", "Beyond joint limits", "°", "largest violation of a joint range", reduce="max")

_TERMS = "mimoc.runtime.quantities"  # The module that has the terms of quantities over control steps.
_of_steps = partial(Quantity, steps=("run",))

CONTACTS_SELF = _of_steps(
    "contacts_self",
    "Contacts with the own body",
    about="mean number of contacts between parts of the own body",
    read=_TERMS,
)
HIP_PATH = _of_steps("hip_path_m", "Path of the hip", "m", "length of the path of the hip", term=_TERMS, reduce="path")
MOTION = (
    HIP_PATH,
    _of_steps(
        "head_height_m", "Largest height of the head", "m", "of its centre above z = 0", term=_TERMS, reduce="max"
    ),
    _of_steps(
        "head_lowest_m", "Smallest height of the head", "m", "of its centre above z = 0", term=_TERMS, reduce="min"
    ),
    _of_steps("joint_speed_rad_s", "Joint speed", "rad/s", "mean absolute velocity over joints and steps", term=_TERMS),
    _of_steps("unstable", "Simulation became unstable", about="whether it did at any time", reduce="any"),
)

_of_policies = partial(Quantity, steps=())
_REACHING = "of the policies that reach"
_HAND_ERROR = "Distance from {}hand to target after 1.5 s, median"

POLICIES = (
    _of_policies("hand_error_m", _HAND_ERROR.format(""), "m", _REACHING),
    _of_policies("hand_targets", "Targets of each hand", about=_REACHING),
    *(
        quantity
        for side in ("left", "right")
        for quantity in (
            _of_policies(f"{side}_hand_error_m", _HAND_ERROR.format(f"{side} "), "m", _REACHING),
            _of_policies(
                f"{side}_hand_reached_share",
                f"Share of its targets that the {side} hand reaches",
                about=f"to which it comes within 2 cm before the next one; {_REACHING}",
                limits=(0.0, 1.0),
            ),
        )
    ),
    _of_policies(
        "fell_after_s",
        "Too weak or too unsteady to sit unsupported: fell over after",
        "s",
        "of the policies that keep sitting",
    ),
    _of_policies("held_s", "Posture held for", "s", "of the behaviours that keep a posture"),
    _of_policies("held_share", "Held to the end", about="share of episodes, of the behaviours that keep a posture"),
    _of_policies("gaze_error_deg", "Error of the gaze, median", "°", "of the behaviour look_at"),
    _of_policies("fixations_per_min", "Things looked at", "1/min", "of look_around, and of look_at what is seen"),
    _of_policies("reached_s", "Touched its target after", "s", "of the behaviour reach_for"),
    _of_policies("hand_closest_m", "Least distance of palm and target", "m", "of the behaviour reach_for"),
    _of_policies("hand_units", "Movement units of a reach that arrived", about="of the behaviour reach_for"),
    _of_policies(
        "hand_path_ratio",
        "Path by straight line of a reach that arrived",
        about="from when the hand is first faster than .05 m/s; of the behaviour reach_for",
    ),
    _of_policies("kick_hip_deg", "Excursion of the hip", "°", "of the behaviour kick"),
)
"""What policies report besides; see `Policy`."""

_of_episodes = partial(Quantity, over="episode", steps=("run", "train"))

RETURN = _of_episodes(
    "return",
    "Return of an episode",
    about="mean return of the completed episodes",
    field="total_reward",
    curve="episode_return",
)
SUCCESS = _of_episodes(
    "success", "Share of episodes that succeed", about="of the completed ones", curve="success_rate", limits=(0.0, 1.0)
)
TIME_TO_SUCCESS = _of_episodes(
    "time_to_success_s", "Time to success", "s", "mean simulated time", curve="time_to_success_s", limits=(0.0, None)
)
EPISODES = _of_episodes(
    "episodes",
    "Completed episodes",
    about="number of episodes that ended",
    reduce="count",
    field="steps",
    curve="episodes",
)

_of_learning = partial(Quantity, over="episode", steps=())

EPISODE_STEPS = _of_learning(
    "episode_steps",
    "Length of an episode",
    "control steps",
    "mean length of the completed episodes",
    curve="episode_steps",
    limits=(0.0, None),
)
TRAINED = _of_learning("trained_steps", "Control steps of training", about="of all environments", curve="steps")
UNFINISHED = _of_learning("unfinished", "Unfinished episodes", about="under way at that time", curve="unfinished")
UNFINISHED_RETURN = _of_learning(
    "unfinished_return", "Their return so far", about="not that of whole ones", curve="unfinished_return"
)
UNFINISHED_STEPS = _of_learning(
    "unfinished_steps", "Their length so far", "control steps", "not that of whole ones", curve="unfinished_steps"
)

LEARNING = (SUCCESS, TIME_TO_SUCCESS, RETURN, EPISODE_STEPS)  # What is drawn of a learning curve.
SO_FAR = {RETURN: UNFINISHED_RETURN, EPISODE_STEPS: UNFINISHED_STEPS}
"""What there is so far of episodes that have not ended, by what it will be."""
CURVE = (TRAINED, EPISODES, *LEARNING, UNFINISHED, UNFINISHED_RETURN, UNFINISHED_STEPS)
"""All that a learning curve says, but for the time that it took."""

QUANTITIES = Registry(
    Quantity,
    "quantity",
    (
        *(*CHILD, *MILESTONE_AGES.values(), STABLE, ENERGY, BEYOND_LIMITS),
        *(RETURN, SUCCESS, TIME_TO_SUCCESS, EPISODES, CONTACTS_SELF, *MOTION, *POLICIES),
        *(AGE, *CURVE, *CORE, *DETAILS, *JOINTS, *OF_MOVEMENT),
    ),
)
"""In the order in which tables show them."""


def measures() -> Mapping[str, Quantity]:
    """Return the quantities that a cohort can measure, by name."""
    return {name: quantity for name, quantity in QUANTITIES.items() if quantity.steps}


def measured_in(step: str) -> list[Quantity]:
    """Return the quantities that are measured somewhere, such as in the step `run` of a cohort."""
    return [quantity for quantity in QUANTITIES.values() if step in quantity.steps]


UNITS = {"deg": "°", "m": "m", "n": "N", "nm": "N m", "s": "s", "weights": "body weights"}
"""Units of numbers that are no quantities of mimoc's, by the last word of their names."""


def quantity_of(name: str) -> Quantity:
    """Return a quantity; for the name of anything else, one that is called by this name's words, the last its unit."""
    if name in QUANTITIES:
        return QUANTITIES[name]
    words, _, unit = name.rpartition("_")
    label = words if words and unit in UNITS else name
    return Quantity(name, (label[:1].upper() + label[1:]).replace("_", " "), UNITS.get(unit, "") if words else "")
