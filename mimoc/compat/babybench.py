"""Conversion of BabyBench configurations; BabyBench is a competition based on MIMo, whose body is 18 months old.

The keys are those of the BabyBench 2025 starter kit and likely variants of them.
"""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mimoc.base.errors import suggestion
from mimoc.compat.settings import MIMO_AGE_MONTHS, Imported, Settings, infant_name, named, plain
from mimoc.schema.base import shown
from mimoc.schema.names import PAIRED_GROUPS, SIDES, STRENGTH_GROUPS, single_groups
from mimoc.schema.source import FileKind, read

FOLDER = "set the output folder when you train: mimoc train OUT -o DIR"
INTERVAL = "set the interval when you train: mimoc train OUT -o DIR --checkpoint-every STEPS"
SIZE = "set the size when you render: mimoc render OUT -o FILE.png --width PX --height PX"
ADVICE = {
    "save_dir": FOLDER,
    "log_dir": FOLDER,
    "save_logs_every": INTERVAL,
    "save_every": INTERVAL,
    "render_size": SIZE,
    "render_width": SIZE,
    "render_height": SIZE,
    "vision_stereo": "both eyes are always observed; ignore 'eye_left' or 'eye_right' in the observation",
}
KNOWN = (
    *ADVICE,
    *("actuation_model", "behavior", "frame_skip", "max_episode_steps", "position", "proprioception", "scene", "seed"),
    *("touch", "touch_function", "touch_response", "touch_scale", "vestibular", "vision", "vision_resolution"),
)
"""Keys to suggest for an unknown key."""
NO_BEHAVIOR = {"none", "custom"}


def note_unmatched(settings: Settings) -> None:
    """Add a note for each key that has not been converted."""
    behavior = settings.find("behavior", "behaviour")
    if behavior and (word := plain(settings.value(behavior))) not in NO_BEHAVIOR:
        message = f"mimoc has no reward for '{shown(word)}'; write yours as a task (docs/own_reward.md)"
        settings.note(behavior, f"no counterpart; {message}")
    for key in settings.unread_keys():
        similar = suggestion(key[:80], KNOWN)
        advice = f"unknown key; {similar}" if similar.startswith("did you mean") else "unknown key"
        settings.note(key, f"no counterpart; {ADVICE.get(key, advice)}")


CONFIGURATION = FileKind("configuration", "behavior, scene and actuation_model", "scene: base")
MAX_AGE_MONTHS = 24
DEFAULT_NAME = "babybench"


def import_babybench(path: str | Path) -> Imported:
    """Convert a BabyBench configuration, a flat YAML file, into a spec; raise a SpecError with all problems.

    Missing keys have the defaults of BabyBench's examples: all regions are actuated and have skin, nothing is locked,
    and all senses except proprioception are off.
    """
    source = read(path, CONFIGURATION)
    settings = Settings(source)
    age_months = settings.number("age_months", "age", low=0, high=MAX_AGE_MONTHS)
    head = {
        "mimoc": 1,
        "name": infant_name(Path(path).stem, DEFAULT_NAME),
        "age_months": MIMO_AGE_MONTHS if age_months is None else age_months,
        "development": "published",
    }
    sections = {name: read_section(settings) for name, read_section in SECTIONS.items()}
    note_unmatched(settings)
    said = {name: section for name, section in sections.items() if section}
    return Imported("BabyBench", source.file, head | said, settings.notes())


PROPRIOCEPTION = ("velocity", "torque", "limits", "actuation")
QUANTITIES = {
    "force_vector": "force_vector",
    "force": "force_vector",
    "force_vector_global": "force_vector_global",
    "normal": "normal",
    "normal_force": "normal",
}
RESPONSES = {"linear": "linear", "nearest": "nearest", "spread_linear": "linear", "spread_exponential": "linear"}
NO_RESPONSE = {"spread_exponential": "no counterpart; converted to spread_linear"}
DENSITIES = (0.1, 10.0)  # Range of the density of skin points in mimoc.
MAX_PX = 2048
FOVY_DEG = (1.0, 170.0)


def read_senses(settings: Settings) -> dict[str, Any]:
    """Return the section `senses` of a spec."""
    vestibular = {} if _switch(settings, "vestibular") else None
    senses = {"proprioception": _proprioception(settings), "vestibular": vestibular}
    senses |= {"touch": _touch(settings), "vision": _vision(settings)}
    return {name: sense for name, sense in senses.items() if sense is not None}


def _switch(settings: Settings, *names: str) -> bool | None:
    forms = [form for name in names for form in (name, f"{name}_active", f"{name}_on", f"{name}_enabled")]
    return settings.flag(*forms, *(f"use_{name}" for name in names))


def _proprioception(settings: Settings) -> dict[str, Any] | None:
    if _switch(settings, "proprioception", "proprio") is False:
        settings.ignore("proprioception_", "proprio_")
        return None
    felt = {name: settings.flag(f"proprio_{name}", f"proprioception_{name}") for name in PROPRIOCEPTION}
    for name, wanted in felt.items():
        if wanted is False and (key := settings.find(f"proprio_{name}")):
            settings.note(key, "excluded here; BabyBench's code ignores this key and includes it")
    include = [name for name, wanted in felt.items() if wanted is not False]
    return {} if len(include) == len(PROPRIOCEPTION) else {"include": include}


def _touch(settings: Settings) -> dict[str, Any] | None:
    on = _switch(settings, "touch")
    scale = settings.find("touch_scale")
    if on is False or (scale and settings.value(scale) in (0, 0.0) and settings.value(scale) is not False):
        settings.ignore("touch_")
        return None
    density = _density(settings)
    quantity = settings.choice("touch_function", "touch_quantity", meanings=QUANTITIES)
    key = settings.find("touch_response", "touch_response_function")
    response = settings.choice(key, meanings=RESPONSES) if key else None
    if key and (word := plain(settings.value(key))) in NO_RESPONSE:
        settings.note(key, NO_RESPONSE[word])
    regions = _skin(settings)
    said = {"density": density, "quantity": quantity, "response": response, "regions": regions}
    given = {key: value for key, value in said.items() if value is not None}
    return None if regions == [] or not (on or given) else given


def _density(settings: Settings) -> float | None:
    """Return the density of skin points that corresponds to a scale of their distances."""
    key = settings.find("touch_scale", "touch_scales")
    scale = settings.number(key, low=0.001, high=1000) if key else None
    if key is None or scale is None or scale == 1:
        return None
    lowest, highest = DENSITIES
    density = float(f"{min(max(scale**-2, lowest), highest):.4g}")
    limit = "" if lowest <= scale**-2 <= highest else f", mimoc's {'minimum' if scale > 1 else 'maximum'}"
    settings.note(key, f"interpreted as a factor of the distance between skin points: density {density:g}{limit}")
    return density


def _skin(settings: Settings) -> list[str] | None:
    beside = {"touch_function", "touch_quantity", "touch_scale", "touch_scales"}
    beside |= {"touch_response", "touch_response_function", "touch_active", "touch_on", "touch_enabled"}
    regions, with_skin = read_groups(settings, "touch_", ("which has none", "which has skin"), beside=beside)
    return named(with_skin) if regions and with_skin != set(SINGLE_GROUPS) else None


def _vision(settings: Settings) -> dict[str, Any] | None:
    on = _switch(settings, "vision")
    if on is False:
        settings.ignore("vision_")
        return None
    size_px, width_px, height_px = (
        settings.whole(*keys, low=1, high=MAX_PX)
        for keys in (("vision_resolution", "vision_size"), ("vision_width",), ("vision_height",))
    )
    fovy_deg = settings.number("vision_fovy", "vision_fov", low=FOVY_DEG[0], high=FOVY_DEG[1])
    said = {"width_px": width_px or size_px, "height_px": height_px or size_px, "fovy_deg": fovy_deg}
    given = {key: value for key, value in said.items() if value is not None}
    return {**given, "acuity": "off"} if on or given else None


_WHOLE = {
    "neck": ("neck", "head"),
    "trunk": ("trunk", "body", "torso"),
    "eyes": ("eyes", "eye"),
    **{pair: (pair, pair.removesuffix("s")) for pair in PAIRED_GROUPS},
}
_PARTS = {
    "neck": ("face",),
    "trunk": ("back", "belly", "chest", "hip", "hips"),
    "arms": ("elbows", "forearms", "lower_arms", "shoulders", "upper_arms"),
    "hands": ("finger", "fingers", "palms", "thumbs", "wrists"),
    "legs": ("ankles", "feet", "foot", "knees", "lower_legs", "thighs", "toe", "toes", "upper_legs"),
}
"""Names of regions that are only part of a group in mimoc, by that group."""


@dataclass(frozen=True, slots=True)
class Region:
    """The meaning of a region's name."""

    groups: tuple[str, ...]  # Single groups: for `arms`, those of both sides.
    rank: int  # Specificity: 0 for a part of a group, 1 for a pair of groups, 2 for a single group.


@dataclass(frozen=True, slots=True)
class Switch:
    """A key such as `act_fingers`."""

    key: str
    on: bool
    region: Region


def read_groups(
    settings: Settings,
    prefix: str,
    states: tuple[str, str],
    *,
    default: bool = True,
    merge: Callable[[Iterable[bool]], bool] = any,
    beside: Iterable[str] = (),
    always: frozenset[str] = frozenset(),
) -> tuple[list[Switch], frozenset[str]]:
    """Return the switches of regions and the single groups that these enable; add notes on what has no counterpart.

    Keys begin with *prefix*, such as `act_`, but for *beside*, which are no switches; *states* describe a disabled and
    an enabled group, *merge* (`any` or `all`) combines the switches of a group's parts, and *always* are enabled in any
    case.
    """
    switched = []
    for key in settings.keys(prefix):
        name = key.removeprefix(prefix).lower()
        if key in beside:
            continue
        if name not in REGIONS:
            settings.note(key, f"no counterpart; mimoc has no region '{shown(name)}', {suggestion(name, REGIONS)}")
        elif (on := settings.flag(key)) is not None:
            switched.append(Switch(key, on, REGIONS[name]))
    enabled = always | {group for group in SINGLE_GROUPS if merge(_values(group, switched, default))}
    for switch in switched:
        against = [group for group in switch.region.groups if (group in enabled) != switch.on]
        if against and switch.region.rank == 0:
            group = " and ".join(named(against))
            word = "true" if switch.on else "false"
            message = f"has no counterpart; in mimoc this is part of '{group}', {states[not switch.on]}"
            settings.note(switch.key, f"{word} {message}")
    return switched, enabled


def _values(group: str, switched: Iterable[Switch], default: bool) -> list[bool]:
    of_group = [switch for switch in switched if group in switch.region.groups]
    whole = [switch for switch in of_group if switch.region.rank > 0]
    rank = max((switch.region.rank for switch in whole), default=0)
    values = [switch.on for switch in whole if switch.region.rank == rank] or [default]
    return values + [switch.on for switch in of_group if switch.region.rank == 0]


def _regions() -> dict[str, Region]:
    regions = {}
    for rank, table in ((1, _WHOLE), (0, _PARTS)):
        for group, names in table.items():
            for name in names:
                regions[name] = Region(PAIRED_GROUPS.get(group, (group,)), rank)
                if group in PAIRED_GROUPS:
                    one = {"feet": "foot", "toes": "toe", "fingers": "finger"}.get(name, re.sub("s$", "", name))
                    for form, side in {f"{side}_{form}": side for side in SIDES for form in (name, one)}.items():
                        regions[form] = Region((f"{side}_{group.removesuffix('s')}",), 2 * rank)
    return regions


REGIONS = _regions()
SINGLE_GROUPS = tuple(group for group in STRENGTH_GROUPS if group not in PAIRED_GROUPS)


PHYSICS_STEP_MS = 5  # Duration of MIMo's physics step, in which `frame_skip` counts.
LONGEST_STEP_MS = 1000
MAX_STEPS = 10**9
MAX_SEED = 2**53

BODIES = {"hand_regard": "five_finger"}  # Behaviours with MIMo's second body; the others have the first.
CUBES = ("bus", "robot", "sofa", "truck")
"""The toys of mimoc that are most similar to cubes: they stand on the floor and have edges."""
SCENES: dict[str, dict[str, Any]] = {
    "base": {"kind": "flat"},
    "flat": {"kind": "flat"},
    "crib": {"kind": "crib", "held": ["lower_body"]},
    "cubes": {"kind": "flat", "pose": "sitting", "held": ["hip"], "toys": {"subset": list(CUBES)}},
}
"""Section `scene` by BabyBench's scene, with the body that BabyBench welds to the world."""
SCENE_LOCKS = {"cubes": ("trunk", "legs")}  # Groups that a scene always locks; BabyBench locks single joints of them.
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


SECTIONS: dict[str, Callable[[Settings], dict[str, Any]]] = {
    "body": read_body,
    "actuation": read_actuation,
    "senses": read_senses,
    "scene": read_scene,
    "control": read_control,
    "task": read_task,
}
"""Function that returns each section of the spec; empty sections are left out."""
