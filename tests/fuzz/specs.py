"""Specs that are spoilt by chance: each is read and built, or refused in clear lines, and soon.

`attempt` is one try, and `fuzz_specs` as many as there is time for. A try is known by its seed and number.
"""

import random
import re
import time
from collections import Counter
from pathlib import Path

import mimoc
from mimoc.errors import SpecError
from mimoc.schema import read_spec
from mimoc.schema.source import parse

ROOT = Path(__file__).resolve().parents[2]
LONGEST_S = 5.0
"""CPU time of a try, but for the first ones, which import what they need."""
BUILT = 0.5
"""Share of the specs that can be read that are built, too."""
STRANGE = (
    *("5e-324", "1e308", "1e-320", "-0.0", "-1", "0", "1e400", ".nan", "-.inf", "99.99999999999999", "1.0e-17"),
    *("9" * 400, "0x" + "f" * 400, "0." + "9" * 400, "18446744073709551616", "9007199254740993", "1e18", "0o777"),
    *("true", "~", "''", "{}", "[]", "[1, 2]", "[2, 1]", "{a: 1}", "no", "012", "1:30", "!!int 3", "&a [*a]", "*b"),
    *('"\\x1b[31m"', '"\\0"', '"\\ud800"', '"\\u202e"', "\x07", "\x7f", "\u202e", "\U0001f476", "\ufeff", "\t"),
    *(
        "[" * 3000,
        "[" * 500 + "]" * 500,
        "{" * 500,
        "? " * 500,
        "- " * 500 + "a",
        "x" * 5000,
        "/dev/zero",
        "../..",
        "a\\0b",
    ),
)
"""What is put in place of values; what was once a fault stays in here."""
NUMBER = re.compile(r"\b\d+(\.\d+)?\b")
KEYS = (
    *("length_percentile", "weight_kg", "foot_length_cm", "left_forearm_circumference_cm", "girth", "density", "cpd"),
    *(
        "acuity",
        "fovy_deg",
        "foveation",
        "sensory_ms",
        "vision_ms",
        "motor",
        "delay_jitter_ms",
        "seed",
        "size_m",
        "root",
    ),
    *("count", "subset", "held", "remove", "regions", "locked", "strength", "step_ms", "timestep_ms", "steps", "hand"),
    *("age_months", "name", "mimoc", "strength_age_months", "supersample", "width_px", "? [a]", "<<", "'\\n'"),
)


def fuzz_specs(seed: int, seconds: float) -> Counter[str]:
    """Try spoilt specs for a time; return how many were built, read and refused.

    Raises:
        AssertionError: If mimoc fails in any other way than by clear errors; the message says with which number.
    """
    found, end, number = Counter[str](), time.monotonic() + seconds, 0
    while time.monotonic() < end:
        start = time.process_time()
        try:
            found[attempt(random.Random(f"{seed}/{number}"))] += 1
        except Exception as error:
            raise AssertionError(f"specs, seed {seed}, try {number}: {error!r}") from error
        taken_s = time.process_time() - start
        assert number < 5 or taken_s < LONGEST_S, f"specs, seed {seed}, try {number}: {taken_s:.1f} s"
        number += 1
    return found


def attempt(chance: random.Random) -> str:
    """Read one spoilt spec, and perhaps build it; return what became of it: `built`, `read` or `refused`."""
    text = spoilt(chance)
    try:
        spec = read_spec(parse(text.encode("utf-8", "surrogatepass"), "spec.yaml"))
        if chance.random() > BUILT:
            return "read"
        bundle = mimoc.build(spec)
    except SpecError as error:
        unclear = [line for line in str(error).splitlines() if not (line and line.isprintable())]
        if unclear:
            raise ValueError(f"unclear: {unclear[0]!r}") from error
        return "refused"
    read_spec(parse(bundle.files["resolved.yaml"], "resolved.yaml"))
    return "built"


def spoilt(chance: random.Random) -> str:
    """Return the text of a config with a few lines changed."""
    lines = chance.choice(_texts()).splitlines()
    for _ in range(chance.choice((1, 1, 2, 3))):
        _spoil(lines, chance)
    return "\n".join(lines) + "\n"


def _spoil(lines: list[str], chance: random.Random) -> None:
    at = chance.randrange(len(lines))
    key, colon, value = lines[at].partition(":")
    match chance.choice(("value", "number", "number", "number", "key", "line", "cut")):
        case "value":
            lines[at] = f"{key}{colon} {chance.choice(STRANGE)}"
        case "number":
            far = chance.choice((0.1, 0.3, 3.0))
            lines[at] = (
                key + colon + NUMBER.sub(lambda word: f"{float(word[0]) * chance.lognormvariate(0, far):.4g}", value)
            )
        case "key":
            margin = " " * chance.choice((0, 2, 4))
            lines.insert(at, f"{margin}{chance.choice(KEYS)}: {chance.choice(STRANGE)}")
        case "line":
            lines.insert(at, lines.pop(chance.randrange(len(lines))))
        case "cut":
            middle = chance.randint(0, len(lines[at]))
            lines[at] = lines[at][:middle] + chance.choice(STRANGE)[:20] + lines[at][middle + chance.randint(0, 4) :]


def _texts() -> list[str]:
    return [path.read_text(encoding="utf-8") for path in sorted((ROOT / "configs").glob("*.yaml"))]
