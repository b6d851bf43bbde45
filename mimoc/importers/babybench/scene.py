"""BabyBench's body, scenes, control step, episode length and actuation."""

from typing import Any

from mimoc.base.errors import suggestion
from mimoc.importers.babybench.regions import (
    SINGLE_GROUPS,
    enabled_groups,
    named,
    note_coarser_groups,
    switches,
)
from mimoc.importers.settings import Settings, plain
from mimoc.schema.names import single_groups

PHYSICS_STEP_MS = 5
"""Duration of MIMo's physics step, in which `frame_skip` counts."""
LONGEST_STEP_MS = 1000
"""Longest control step in mimoc."""
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
"""Differences from BabyBench's scene."""
POSES = {
    "prone": "prone",
    "sit": "sitting",
    "sitting": "sitting",
    "stand": "standing",
    "standing": "standing",
    "supine": "supine",
}
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


def scene_locks(settings: Settings) -> frozenset[str]:
    """Return the muscle groups that a scene always locks."""
    key = settings.find("scene")
    groups = SCENE_LOCKS.get(plain(settings.value(key)), ()) if key else ()
    return frozenset(single_groups(groups))


def read_control(settings: Settings) -> dict[str, Any]:
    """Return the section `control` of a spec."""
    skipped = settings.whole("frame_skip", low=1, high=LONGEST_STEP_MS // PHYSICS_STEP_MS)
    return {} if skipped is None else {"step_ms": skipped * PHYSICS_STEP_MS, "timestep_ms": PHYSICS_STEP_MS}


def read_task(settings: Settings) -> dict[str, Any]:
    """Return the section `task` of a spec: no goal, with a maximum number of steps."""
    steps = settings.whole("max_episode_steps", "max_steps", "episode_steps", low=1, high=MAX_STEPS)
    return {} if steps is None else {"kind": "free", "steps": steps}


MODELS = {
    "spring_damper": "torque",
    "torque": "torque",
    "muscle": "muscle",
    "muscles": "muscle",
    "position": "position",
    "positional": "position",
}
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
    locking, acting = switches(settings, "lock_"), switches(settings, "act_")
    by_scene = scene_locks(settings)
    locked = enabled_groups(locking, default=False, merge=all) | by_scene
    acts = enabled_groups(acting, default=True, merge=any)
    note_coarser_groups(settings, locking, locked, {True: "which is locked", False: "which is not locked"})
    note_coarser_groups(settings, acting, acts, {True: "which is actuated", False: "which is not actuated"})
    for switch in acting:
        if switch.on and locked & set(switch.region.groups):
            groups = " and ".join(named(locked & set(switch.region.groups)))
            settings.note(
                switch.key, f"true has no counterpart; '{groups}' is locked, and locked joints are not actuated"
            )
    section: dict[str, Any] = {"model": model} if model else {}
    if acts - locked != set(SINGLE_GROUPS) - locked:
        section["regions"] = named(acts - locked)
    if locked:
        section["locked"] = named(locked)
    return section
