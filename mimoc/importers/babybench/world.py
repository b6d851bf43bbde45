"""BabyBench's body, scenes, clock and episodes."""

from typing import Any

from mimoc.errors import suggestion
from mimoc.importers.settings import Settings, plain
from mimoc.schema.names import single_groups

PHYSICS_STEP_MS = 5
"""MIMo's, which `frame_skip` counts."""
LONGEST_STEP_MS = 1000
"""One control step of mimoc."""
MAX_STEPS = 10**9
MAX_SEED = 2**53

BODIES = {"hand_regard": "five_finger"}
"""Which behaviours have MIMo's second body; the others have its first."""
CUBES = ("bus", "robot", "sofa", "truck")
"""The toys of mimoc that come nearest: they stand on the floor, and have edges."""
SCENES: dict[str, dict[str, Any]] = {
    "base": {"kind": "flat"},
    "flat": {"kind": "flat"},
    "crib": {"kind": "crib", "held": ["lower_body"]},
    "cubes": {"kind": "flat", "pose": "sitting", "held": ["hip"], "toys": {"subset": list(CUBES)}},
}
"""What they come to, with the part that BabyBench welds to the world."""
SCENE_LOCKS = {"cubes": ("trunk", "legs")}
"""What a scene locks, whatever the configuration says: where BabyBench does so joint by joint, all of the group."""
SCENE_NOTES = {
    "crib": "limbs start as in mimoc's 'supine', where BabyBench has all joints at 0",
    "cubes": "the infant sits upright, with trunk and legs locked and a head that moves; BabyBench's leans back by 55 "
    "degrees, with trunk, hips and knees locked and a head that only swivels",
}
"""What a scene does not have as BabyBench has it."""
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
    """Return the section `body` of a spec: the one of the behaviour, unless another is named."""
    behavior = settings.find("behavior", "behaviour")
    of_behavior = BODIES.get(plain(settings.value(behavior))) if behavior else None
    hands = settings.choice("mimo_version", "mimo_model", "hands", meanings=HANDS) or of_behavior
    other = settings.find("model")
    if other:
        word = plain(settings.value(other))
        hands = hands or HANDS.get(word)
        if word not in HANDS:
            settings.note(other, f"no counterpart; of MIMo's bodies, {suggestion(word[:80], HANDS)}")
    return {"hands": hands} if hands == "five_finger" else {}


def read_scene(settings: Settings) -> dict[str, Any]:
    """Return the section `scene` of a spec."""
    key = settings.find("scene")
    scene = (settings.choice(key, meanings=SCENES) if key else None) or SCENES["base"]
    if key and (said := SCENE_NOTES.get(plain(settings.value(key)))):
        settings.note(key, said)
    if key and "toys" in scene:
        settings.note(key, f"mimoc has no toy cubes; toys with edges lie there instead: {', '.join(CUBES)}")
    pose = settings.choice("position", "pose", "initial_position", "init_position", meanings=POSES)
    seed = settings.whole("seed", low=0, high=MAX_SEED)
    extra = {"pose": pose, "seed": seed}
    return {**scene, **{name: value for name, value in extra.items() if value is not None}}


def scene_locks(settings: Settings) -> frozenset[str]:
    """Return the groups of muscles that a scene locks by itself."""
    key = settings.find("scene")
    groups = SCENE_LOCKS.get(plain(settings.value(key)), ()) if key else ()
    return frozenset(single_groups(groups))


def read_control(settings: Settings) -> dict[str, Any]:
    """Return the section `control` of a spec."""
    skipped = settings.whole("frame_skip", low=1, high=LONGEST_STEP_MS // PHYSICS_STEP_MS)
    return {} if skipped is None else {"step_ms": skipped * PHYSICS_STEP_MS, "timestep_ms": PHYSICS_STEP_MS}


def read_task(settings: Settings) -> dict[str, Any]:
    """Return the section `task` of a spec: nothing to achieve, and an end."""
    steps = settings.whole("max_episode_steps", "max_steps", "episode_steps", low=1, high=MAX_STEPS)
    return {} if steps is None else {"kind": "free", "steps": steps}
