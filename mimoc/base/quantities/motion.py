"""How an infant moves, what it touches, and whether its simulation stays stable."""

from functools import partial

from mimoc.base.quantities.quantity import Quantity

_of_steps = partial(Quantity, term="mimoc.runtime.quantities.motion", steps=("run",))

HIP_PATH = _of_steps("hip_path_m", "Path of the hip", "m", "length of the path of the hip", reduce="path")
HEAD_HEIGHT = _of_steps("head_height_m", "Largest height of the head", "m", "of its centre above z = 0", reduce="max")
HEAD_LOWEST = _of_steps("head_lowest_m", "Smallest height of the head", "m", "of its centre above z = 0", reduce="min")
JOINT_SPEED = _of_steps("joint_speed_rad_s", "Joint speed", "rad/s", "mean absolute velocity over joints and steps")
HAND_ERROR = Quantity(
    "hand_error_m", "Distance from hand to target after 1.5 s, median", "m", "of the policies that reach", steps=()
)
HAND_TARGETS = Quantity("hand_targets", "Targets of each hand", about="of the policies that reach", steps=())
OF_EACH_HAND = tuple(
    quantity
    for side in ("left", "right")
    for quantity in (
        Quantity(
            f"{side}_hand_error_m",
            f"Distance from {side} hand to target after 1.5 s, median",
            "m",
            "of the policies that reach",
            steps=(),
        ),
        Quantity(
            f"{side}_hand_reached_share",
            f"Share of its targets that the {side} hand reaches",
            about="to which it comes within 2 cm before the next one; of the policies that reach",
            steps=(),
            limits=(0.0, 1.0),
        ),
    )
)
FELL_AFTER = Quantity(
    "fell_after_s",
    "Too weak or too unsteady to sit unsupported: fell over after",
    "s",
    "of the policies that keep sitting",
    steps=(),
)
_of_behaviours = partial(Quantity, steps=())
BEHAVING = (
    _of_behaviours("held_s", "Posture held for", "s", "of the behaviours that keep a posture"),
    _of_behaviours("held_share", "Held to the end", about="share of episodes, of the behaviours that keep a posture"),
    _of_behaviours("gaze_error_deg", "Error of the gaze, median", "°", "of the behaviour look_at"),
    _of_behaviours("reached_s", "Touched its target after", "s", "of the behaviour reach_for"),
    _of_behaviours("hand_closest_m", "Least distance of palm and target", "m", "of the behaviour reach_for"),
    _of_behaviours("kick_hip_deg", "Excursion of the hip", "°", "of the behaviour kick"),
)


CONTACTS_SELF = Quantity(
    "contacts_self",
    "Contacts with the own body",
    about="mean number of contacts between parts of the own body",
    read="mimoc.runtime.quantities.motion",
    steps=("run",),
)


_of_poses = partial(Quantity, over="pose", steps=("check",))

STABLE = _of_poses(
    "stable", "Simulation stayed stable", "", "whether it did in all trials", reduce="all", field="passed"
)
ENERGY = _of_poses("energy_j_per_kg", "Kinetic energy", "J/kg", "largest of all trials, per body mass", reduce="max")
BEYOND_LIMITS = _of_poses("beyond_deg", "Beyond joint limits", "°", "largest violation of a joint range", reduce="max")
UNSTABLE = Quantity(
    "unstable", "Simulation became unstable", about="whether it did at any time", reduce="any", steps=("run",)
)
