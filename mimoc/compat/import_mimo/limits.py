"""Bounds of a scene that anyone may have written, checked before MuJoCo reads any of it."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping

from mimoc.base.errors import Problem, SpecError
from mimoc.bundle.mjcf_check import MOST, MOST_ELEMENTS
from mimoc.compat.import_mimo.reading import Element

MOST_MAGNITUDE = 1e10
"""Of any number, as in the MJCF of bundles."""
TIMESTEP_S = 1e-4, 1.0
"""Physics steps that a spec can have (`control.timestep_ms`)."""
MOST_SAMPLES = 2**20
"""Of a height field; a terrain of 10 m at every centimetre."""
MOST_LENGTH_RANGE_STEPS = 1e5
"""Steps by which MuJoCo's compiler may look for the length range of a muscle; by default 1,000."""
BOUNDS: Mapping[str, float] = {
    **dict.fromkeys(("width", "height", "offwidth", "offheight", "resolution"), 4096),
    **dict.fromkeys(("shadowsize", "nrow", "ncol", "dim", "actdim", "nsample", "nuserdata"), 2**14),
    **dict.fromkeys(("njmax", "nconmax"), 1e6),
    **dict.fromkeys(("numslices", "numstacks", "numquads", "nkey"), 1000),
    **dict.fromkeys(("octree_maxdepth", "subdivision"), 8),
    "nstack": 1e8,
}
"""Largest values of attributes for which MuJoCo sets memory or time aside, besides `nuser_*` and `*iterations`."""
BYTES = {"k": 2**10, "m": 2**20, "g": 2**30}
GENERATORS = ("replicate", "composite", "flexcomp")
"""Elements of which MuJoCo makes many."""
ATTACHES = "attaches another model; include its parts, or write them into the scene"
REFUSED: Mapping[str, str] = {
    "plugin": "uses a plug-in of MuJoCo's, which mimoc does not load; remove it",
    "extension": "uses plug-ins of MuJoCo's, which mimoc does not load; remove it",
    "attach": ATTACHES,
}


def check_limits(scene: Element) -> None:
    """Raise a SpecError with all problems unless a scene is small enough and its numbers are sensible."""
    problems = [problem for element in scene.walk() for problem in _problems_of(element)]
    if not problems:
        counts = Counter[str]()
        _count(scene, 1, counts)
        problems = [
            scene.problem(f"has {counts[tag]:,} <{tag}>, copies included; at most {most:,} are read")
            for tag, most in MOST.items()
            if counts[tag] > most
        ]
        if counts.total() > MOST_ELEMENTS:
            problems.append(
                scene.problem(f"has {counts.total():,} elements in all; at most {MOST_ELEMENTS:,} are read")
            )
    if problems:
        raise SpecError(problems)


def _problems_of(element: Element) -> Iterator[Problem]:
    if element.tag in REFUSED:
        yield element.problem(REFUSED[element.tag])
    if element.tag == "flexcomp" and element.get("file"):
        yield element.problem("makes a flexible body of a file, of which bundles have none; remove it")
    numbers = {name: found for name, value in element.attributes.items() if (found := _numbers(name, value))}
    for name, values in numbers.items():
        if not all(abs(value) <= MOST_MAGNITUDE for value in values):
            yield element.problem(f"{name} is no number, or above {MOST_MAGNITUDE:g}; correct it")
        elif max(values) > (most := _bound(element, name)):
            yield element.problem(f"{name} is {max(values):,.12g}; give {most:,.12g} at most")
    if element.tag == "option" and "timestep" in numbers:
        least, most = TIMESTEP_S
        if not least <= numbers["timestep"][0] <= most:
            yield element.problem(f"timestep is {numbers['timestep'][0]:g}; give {least:g} to {most:g} s")
    if element.tag == "hfield" and math.prod(numbers.get(name, [1])[0] for name in ("nrow", "ncol")) > MOST_SAMPLES:
        yield element.problem(f"has more than {MOST_SAMPLES:,} samples; make nrow and ncol smaller")
    if element.tag == "lengthrange":
        total_s, step_s = numbers.get("inttotal", [10.0])[0], numbers.get("timestep", [0.01])[0]
        if not 0 < total_s <= MOST_LENGTH_RANGE_STEPS * step_s:
            yield element.problem("simulates too many steps, or none; leave inttotal and timestep out")
    if element.tag == "size" and _bytes(element.get("memory")) > BYTES["g"]:
        yield element.problem("memory is above 1 GB; leave it out")


def _bound(element: Element, name: str) -> float:
    if element.tag in ("spatial", "site", "geom", "camera") and name != "resolution":
        return math.inf  # A width there is one in metres.
    if name.startswith("nuser_") or name.endswith("iterations"):
        return 1000
    if element.tag in GENERATORS and name == "count":
        return MOST_ELEMENTS
    return BOUNDS.get(name, math.inf)


def _numbers(name: str, value: str) -> list[float]:
    if name in ("name", "class", "childclass", "file", "user"):
        return []
    try:
        return [float(word) for word in value.split()]
    except ValueError:
        return []


def _bytes(memory: str) -> float:
    """Return a size such as `10M` in bytes, 0 if it is none: MuJoCo says so."""
    number, factor = (memory[:-1], BYTES.get(memory[-1:].lower(), 0)) if memory[-1:].isalpha() else (memory, 1)
    try:
        return float(number) * factor
    except ValueError:
        return 0.0


def _count(element: Element, copies: float, counts: Counter[str]) -> None:
    """Count elements as MuJoCo will have them: with the copies that it makes."""
    made = max(1.0, math.prod(_numbers("count", element.get("count")))) if element.tag in GENERATORS else 1.0
    copies = min(copies * made, 1e12)  # Beyond any limit already.
    counts[element.tag] += math.ceil(copies)
    if element.tag in ("composite", "flexcomp"):
        counts["body"] += math.ceil(copies)
    for child in element.children:
        _count(child, copies, counts)
