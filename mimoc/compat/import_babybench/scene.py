"""BabyBench's body, scenes, control step, episode length and actuation."""

from typing import Any

from mimoc.base.errors import suggestion
from mimoc.compat.import_babybench.senses import SINGLE_GROUPS, named, read_groups
from mimoc.compat.settings import Settings, plain
from mimoc.schema.names import single_groups

PHYSICS_STEP_MS = 5
"""Duration of MIMo's physics step, in which `frame_skip` counts."""
LONGEST_STEP_MS = 1000
MAX_STEPS = 10**9
MAX_SEED = 2**53

BODIES = {"hand_regard": "five_finger"}
"""Behaviours with MIMo's second body; the others have the first."""
CUBES = ("bus", "robot", "sofa", "truck")
"""The toys of mimoc that are most similar to cubes: they stand on the floor and have edges."""
SCENES: dict[str, dict[str, Any]] = {
    "base": {"kind": "flat"},
    "flat": {"kind": "flat"},
    "crib": {"kind": "crib", "held": ["lower_body"]},
    "cubes": {"kind": "flat", "pose": "sitting", "held": ["hip"], "toys": {"subset": list(CUBES)}},
}
"""Section `scene` by BabyBench's scene, with the body that BabyBench welds to the world."""
SCENE_LOCKS = {"cubes": ("trunk", "legs")}
"""Groups that a scene always locks; BabyBench locks single joints of them."""
SCENE_NOTES = {
    "crib": "the initial pose is mimoc's 'supine', where BabyBench has all joints at 0",
    "cubes": "the infant sits upright, with trunk and legs locked and a free head; BabyBench's leans back by 55 "
    "degrees, with trunk, hips and knees locked and a head that can only turn",
}
POSES = {"sit": "sitting", "stand": "standing", **{pose: pose for pose in ("prone", "sitting", "standing", "supine")}}
HANDS = {
    **dict.fromkeys(("1", "v1", "mimo_v1", "mitten"), "mitten"),
    **dict.fromkeys(("2", "v2", "mimo_v2", "five_finger"), "five_finger"),
}
"""MIMo's bodies: its second one has five fingers."""


def read_body(settings: Settings) -> dict[str, Any]:
    """Return the section `body` of a spec: the body of the behaviour, unless another one is named."""
    behavior = settings.find("behavior", "behaviour")
    of_behavior = BODIES.get(plain(settings.value(behavior))) if behavior else None
    hands = settings.choice("mimo_version", "mimo_model", "hands", meanings=HANDS) or of_behavior
    other = settings.find("model")
    if other:
        word = plain(settings.value(other))
        hands = hands or HANDS.get(word)
        if word not in HANDS:
            settings.note(other, f"no counterpart; not one of MIMo's bodies; {suggestion(word[:80], HANDS)}")
    return {"hands": hands} if hands == "five_finger" else {}


def read_scene(settings: Settings) -> dict[str, Any]:
    """Return the section `scene` of a spec."""
    key = settings.find("scene")
    scene = (settings.choice(key, meanings=SCENES) if key else None) or SCENES["base"]
    if key and (said := SCENE_NOTES.get(plain(settings.value(key)))):
        settings.note(key, said)
    if key and "toys" in scene:
        settings.note(key, f"mimoc has no toy cubes; the scene has other toys instead: {', '.join(CUBES)}")
    pose = settings.choice("position", "pose", "initial_position", "init_position", meanings=POSES)
    seed = settings.whole("seed", low=0, high=MAX_SEED)
    extra = {"pose": pose, "seed": seed}
    return {**scene, **{name: value for name, value in extra.items() if value is not None}}


def read_control(settings: Settings) -> dict[str, Any]:
    """Return the section `control` of a spec."""
    skipped = settings.whole("frame_skip", low=1, high=LONGEST_STEP_MS // PHYSICS_STEP_MS)
    return {} if skipped is None else {"step_ms": skipped * PHYSICS_STEP_MS, "timestep_ms": PHYSICS_STEP_MS}


def read_task(settings: Settings) -> dict[str, Any]:
    """Return the section `task` of a spec: no goal, with a maximum number of steps."""
    steps = settings.whole("max_episode_steps", "max_steps", "episode_steps", low=1, high=MAX_STEPS)
    return {} if steps is None else {"kind": "free", "steps": steps}


MODELS = {model: model for model in ("torque", "muscle", "position")}
MODELS |= {"spring_damper": "torque", "muscles": "muscle", "positional": "position"}
"""The actuation model of mimoc by its name in BabyBench, MIMo or mimoc."""
ORDER = "the action is ordered by limb in mimoc and by region in BabyBench"
COMMANDS = {
    "torque": "",
    "muscle": "; the two muscles of a joint are adjacent in it, where BabyBench has all muscles of one direction first",
    "position": "; its range is -1 to 1 for the range of each joint, where BabyBench uses angles in radians",
}
"""Further differences in the action, by mimoc's actuation model."""


def read_actuation(settings: Settings) -> dict[str, Any]:
    """Return the section `actuation` of a spec, without mimoc's defaults."""
    key = settings.find("actuation_model", "actuation")
    model = settings.choice(key, meanings=MODELS) if key else None
    if key and model:
        settings.note(key, f"{ORDER}{COMMANDS[model]}")
    scene = settings.find("scene")
    always = single_groups(SCENE_LOCKS.get(plain(settings.value(scene)), ()) if scene else ())
    locks = "which is not locked", "which is locked"
    _, locked = read_groups(settings, "lock_", locks, default=False, merge=all, always=frozenset(always))
    acting, acts = read_groups(settings, "act_", ("which is not actuated", "which is actuated"))
    for switch in acting:
        if switch.on and (groups := locked & set(switch.region.groups)):
            names = " and ".join(named(groups))
            settings.note(
                switch.key, f"true has no counterpart; '{names}' is locked, and locked joints are not actuated"
            )
    section: dict[str, Any] = {"model": model} if model else {}
    if acts - locked != set(SINGLE_GROUPS) - locked:
        section["regions"] = named(acts - locked)
    if locked:
        section["locked"] = named(locked)
    return section
