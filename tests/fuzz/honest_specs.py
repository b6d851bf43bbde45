"""Specs that anyone might write, drawn from the JSON Schema two sections at a time, all with equal weight, and used.

A section is at the top level of a spec, or has keys of its own one level below. Of each, a few keys are drawn, each
with equal weight. What the schema admits and mimoc refuses must be refused in clear lines; the keys that these name are
left out then, until there is an infant, which must go through everything (`honest_uses.py`).
"""

import json
from collections.abc import Callable, Sequence
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from fuzz.fuzzing import Fuzzer, check_clear
from fuzz.honest_uses import DEAR, check
from fuzz.mutations import OMITTED, Drawing, Hints, among, between, pick, whole

import mimoc
from mimoc.base.errors import SpecError
from mimoc.components.toys.builtin import NAMES as TOYS
from mimoc.fits import measure
from mimoc.schema.impairments import PRESETS
from mimoc.schema.infant import read_spec
from mimoc.schema.json_schema import json_schema
from mimoc.schema.kinds import SENSES
from mimoc.schema.names import MEASUREMENT_KEYS, RANGED, SIDED_MEASUREMENT_KEYS, limb_bodies, unsided
from mimoc.schema.source import in_memory

MAX_KEYS = 3  # Keys of a section that are drawn.
ENDS, NEAR = 0.1, 0.4
"""How often a number is one of the ends of its range, and how often it is near the default, if it has one."""
ROUNDS = 40  # How often keys are left out because of which a spec is refused.
AGES_MONTHS = (0, 3, 6, 9, 12, 24)
FINGERS = {*limb_bodies("five_finger")} - {*limb_bodies("mitten")}
NAMES = ("one", "two", "three")
PARTS = ("head", "chest", "left_hand", "right_foot")

NEEDED = ("name", "kind", "do")  # Keys without which their section makes no sense.

Section = tuple[str, ...]  # Keys that lead to a section.


class Case(NamedTuple):
    """What is drawn, and what it is used for."""

    sections: tuple[Section, ...]
    dear: tuple[str, ...]  # Names of dear uses.
    seed: tuple[int, ...]  # Of the draw.


def _place(generator: np.random.Generator) -> Any:
    x_cm, y_cm = (round(float(value), 1) for value in generator.uniform(-70, 70, 2))
    words = [f"{relation} {pick(generator, (*PARTS, *NAMES))}" for relation in ("in front of", "beside", "on")]
    return pick(generator, ({"x_cm": x_cm, "y_cm": y_cm}, "within reach of left_hand", *words))


def _measurements(generator: np.random.Generator) -> dict[str, float]:
    """Return a few measurements that are not far from those of a child of any age."""
    average_m = measure(pick(generator, AGES_MONTHS))
    keys = generator.permutation(MEASUREMENT_KEYS + SIDED_MEASUREMENT_KEYS)[: generator.integers(1, MAX_KEYS)]
    return {key: round(100 * average_m[unsided(key)] * float(generator.uniform(0.8, 1.25)), 2) for key in keys.tolist()}


def _contractures(generator: np.random.Generator) -> dict[str, list[float]]:
    names = generator.permutation(sorted(RANGED))[: generator.integers(1, MAX_KEYS)].tolist()
    return {name: [between(-90, 0)(generator), between(0, 90)(generator) - 5] for name in names}


HINTS: Hints = {
    "measurements": _measurements,
    # What needs files, plug-ins or names that are said elsewhere in the spec.
    **dict.fromkeys(("root", "subset", "mesh", "picture", "textures", "extra"), among(OMITTED)),
    "source": among("builtin"),
    "toy": among(*TOYS),
    "name": among(*NAMES),
    "start_at": among(NAMES[0]),
    "range": _contractures,
    "object": among(*NAMES),
    "above": among(*NAMES, *PARTS),
    "at": _place,
    # What a spec may say that only takes longer.
    "step_ms": among(10.0, 10.0, 20.0, 30.0, 50.0, 100.0),
    "timestep_ms": among(1.0, 2.0, 2.5, 5.0, 10.0),
    "count": among([0, 0], [0, 2], [1, 1]),
    "steps": whole(1, 30),
    "sample_rate_hz": among(8000, 16000, 24000, 48000),
    "density": between(0.1, 2),
    "supersample": whole(1, 3),
    **dict.fromkeys(("width_px", "height_px"), whole(1, 24)),
    **{
        f"{sense}_ms": among(0.0, 10.0, 50.0, 100.0, 200.0) for sense in ("motor", "proprioception", "sensory", "touch")
    },
    **{f"{sense}_ms": among(0.0, 10.0, 50.0, 100.0, 200.0) for sense in ("vestibular", "vision", "hearing", "pain")},
    "delay_jitter_ms": among(0.0, 10.0, 50.0),
    "at_s": among(0.0, 0.01, 0.05),
    **dict.fromkeys(("delay_ms", "pause_ms", "duration_ms"), among(0.0, 10.0, 400.0, 1000.0)),
    "yoked_s": among([0.0], [0.01, 0.05]),
}
MIN_VALUES = {"spacing_cm": 0.5}  # Of numbers below some keys: less only takes longer.


@cache
def _schema() -> dict[str, Any]:
    return json_schema("infant")


def sections() -> list[Section]:
    """Return all sections: those of a spec, and those of them that have keys of their own."""
    drawing, found = SpecDrawing(np.random.default_rng(0)), list[Section]()
    for key, node in drawing.schema["properties"].items():
        if key in ("mimoc", "name"):
            continue
        inner = drawing.resolved(node).get("properties", {})
        below = [name for name, child in inner.items() if drawing.is_section(child) and HINTS.get(name) is not OMITTED]
        found += [(key, name) for name in below if name != "textures"]
        if not inner or len(below) < len(inner):
            found.append((key,))
    return found


class SpecDrawing(Drawing):
    """Draws a few keys of each section, and numbers from all of their range, but more near the default."""

    def __init__(self, generator: np.random.Generator):
        super().__init__(_schema(), HINTS, generator)

    def is_section(self, node: Any) -> bool:
        """Return whether a node has keys of its own, or is a list of what has."""
        node = self.resolved(node)
        items = map(self.resolved, node.get("items", {}).get("oneOf", ()))
        return bool(node.get("properties")) or any("properties" in kind for kind in items)

    def section(self, path: Section) -> Any:
        node = self.schema
        for key in path:
            node = self.resolved(node["properties"][key])
        if "items" in node:
            return self.value(node)
        plain = {key: child for key, child in node.get("properties", {}).items() if not self.is_section(child)}
        return self.value({**node, "properties": plain} if plain and len(path) == 1 else node)

    def _object(self, node: Any) -> dict[str, Any]:
        known = node.get("properties", {})
        needed = [key for key in known if key in node.get("required", ()) or "const" in known[key]]
        free = [key for key in known if key not in needed]
        most = min(len(free), MAX_KEYS)
        chosen = {
            *needed,
            *self.generator.permutation(free)[: self.generator.integers(min(1, most), most + 1)].tolist(),
        }
        drawn = {key: self._keyed(key, inner) for key, inner in known.items() if key in chosen}
        if more := node.get("additionalProperties"):
            names = node["propertyNames"]["enum"]
            for name in self.generator.permutation(names)[: self.generator.integers(1, MAX_KEYS)].tolist():
                drawn[name] = self.value(more)
        return {key: value for key, value in drawn.items() if value is not OMITTED}

    def _keyed(self, key: str, node: Any) -> Any:
        if key in self.hints and not (key == "object" and "enum" in node):
            return self.hints[key](self.generator)
        if key in MIN_VALUES:
            node = self.resolved(node)
            node = {**node, "additionalProperties": {**node["additionalProperties"], "minimum": MIN_VALUES[key]}}
        return self.value(node)

    def _number(self, node: Any) -> float:
        least, most = node.get("minimum", node.get("exclusiveMinimum", 0.0)), node.get("maximum")
        usual, draw = node.get("default"), self.generator.random()
        most = 10 * (usual or 1.0) if most is None else most
        if draw < ENDS:
            return float(pick(self.generator, (least, most) if "minimum" in node else (most,)))
        if usual and draw < ENDS + NEAR:
            return round(float(np.clip(usual * self.generator.lognormal(0, 0.4), least, most)), 3)
        if least >= 0 and most >= 1000:  # Such as from 0.1 to 1000.
            return round(float(np.exp(self.generator.uniform(np.log(max(least, 0.1)), np.log(most)))), 3)
        return round(float(self.generator.uniform(least, most)), 3)


def drawn(pair: Sequence[Section], generator: np.random.Generator) -> dict[str, Any]:
    drawing = SpecDrawing(generator)
    data: dict[str, Any] = {"mimoc": 1, "name": "kim", "age_months": pick(generator, AGES_MONTHS)}
    for path in pair:
        data = _merged(data, path, drawing.section(path))
    return _completed(data)


def _completed(data: dict[str, Any]) -> dict[str, Any]:
    body, scene, delays, noise = (data.get(key, {}) for key in ("body", "scene", "delays", "noise"))
    for sense in SENSES:
        if any(key.startswith(f"{sense}_") for key in (*delays, *noise)):
            data.setdefault("senses", {}).setdefault(sense, {})
    if noise.get("delay_jitter_ms"):
        data.setdefault("delays", {}).setdefault("preset", "physiological")
    if any(key.endswith("percentile") for key in body.get("individual", {})):
        body["individual"].setdefault("sex", "female")
    spacing_cm = data.get("senses", {}).get("touch", {}).get("spacing_cm", {})
    if {*body.get("remove", ()), *body.get("parts", {}), *spacing_cm} & FINGERS:
        data.setdefault("body", {})["hands"] = "five_finger"
    sided, impairments = {name for name, preset in PRESETS.items() if preset.has_side}, data.get("impairments", {})
    if impairments.get("preset", "hemiparesis") in sided and {"preset", "side"} & impairments.keys():
        impairments.setdefault("preset", "hemiparesis")
        impairments.setdefault("side", "left")
    else:
        impairments.pop("side", None)
    if "start_at" in scene:
        scene.setdefault("objects", [{"kind": "mat"}])
        scene["start_at"] = NAMES[0]
    for item, name in zip(scene.get("objects", ()), NAMES, strict=False):
        item["name"] = name
    return data


def _merged(data: Any, path: Section, value: Any) -> Any:
    if path:
        return {**data, path[0]: _merged(data.get(path[0], {}), path[1:], value)}
    return {**data, **value} if isinstance(data, dict) and isinstance(value, dict) else value


def honest(data: dict[str, Any], build: Callable[[mimoc.InfantSpec], Any] = mimoc.build) -> tuple[dict[str, Any], int]:
    """Return a spec without what is refused of it, in clear lines, and how many times it was refused."""
    for refused in range(ROUNDS):
        try:
            build(read_spec(in_memory(data, "<spec>", Path())))
        except SpecError as error:
            check_clear(error)
            before = json.dumps(data)
            for key in sorted({problem.key for problem in error.problems}, reverse=True):  # The last of a list first.
                _remove(data, key)
            if json.dumps(data) == before:
                raise AssertionError(f"refused at a key that is not there: {error}") from None
        else:
            return data, refused
    raise AssertionError(f"refused {ROUNDS} times")


def _remove(data: Any, key: str) -> None:
    """Remove a key, `scene.objects[1].at`, or what it is below of, if that is not there or the key is needed."""
    steps: list[Any] = [
        int(step) if step.isdigit() else step for step in key.replace("[", ".").replace("]", "").split(".")
    ]
    if steps == ["age_months"]:
        data["age_months"] = 12
        return
    parents = [data]
    for step in steps[:-1]:
        inside = parents[-1]
        if step not in (range(len(inside)) if isinstance(inside, list) else inside):
            break
        parents.append(inside[step])
    at, inside = steps[len(parents) - 1], parents[-1]
    if isinstance(inside, dict) and (at not in inside or at in NEEDED):
        at, inside = steps[len(parents) - 2], parents[-2]
    if isinstance(inside, dict) or at < len(inside):
        del inside[at]


def cases(seed: int, count: int) -> list[Case]:
    """Return every section alone, then every pair with one of the dear uses, and again with others, up to a count.

    In each round each section is put to each dear use with some others.
    """
    every, uses = sections(), tuple(DEAR)
    pairs = [*combinations(range(len(every)), 2)]
    found = [((section,), (uses[number % len(uses)],)) for number, section in enumerate(every)]
    while len(found) < count:
        shift = 3 * len(found) // len(pairs)
        found += [((every[one], every[two]), (uses[(one + two + shift) % len(uses)],)) for one, two in pairs]
    return [Case(pair, dear, (seed, number)) for number, (pair, dear) in enumerate(found[:count])]


def use_drawn(case: Case, folder: Path) -> int:
    """Draw a spec of a case and use it in a folder; return how many times it was refused before it was valid.

    Raises:
        AssertionError: If anything fails; the message has the spec, and how to repeat it.
    """
    generator = np.random.default_rng(case.seed)
    data = drawn(case.sections, generator)
    try:
        data, refused = honest(data)
        check(data, case.dear, generator, folder)
    except Exception as error:
        told = f"{type(error).__name__}: {error}"
        raise AssertionError(f"{told}\n{case}, the spec, which is YAML in a line:\n{json.dumps(data)}") from error
    return refused


def attempt(_: None, generator: np.random.Generator, folder: Path) -> None:
    every = sections()
    pair = tuple(every[index] for index in generator.choice(len(every), 2, replace=False).tolist())
    use_drawn(Case(pair, (pick(generator, tuple(DEAR)),), tuple(generator.integers(2**32, size=2).tolist())), folder)


FUZZER = Fuzzer(
    lambda _: None,
    attempt,
    short=1,
    longest_s=60.0,
    largest_mb=2048,  # A process has OpenGL, and keeps what it has read of all infants.
    honest=True,
)
