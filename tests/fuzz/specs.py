"""Specs that are changed by chance: values, numbers and keys of the configs; read, and half of them built."""

import re
from pathlib import Path

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import pick

import mimoc
from mimoc.schema import read_spec
from mimoc.schema.source import parse

ROOT = Path(__file__).resolve().parents[2]
BUILT = 0.5  # Share of the specs that can be read that are built, too.
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


def prepare(_: Path) -> list[str]:
    texts = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "configs").glob("*.yaml"))]
    mimoc.build(read_spec(parse(texts[0].encode(), "spec.yaml")))
    return texts


def attempt(texts: list[str], generator: np.random.Generator, _: Path) -> None:
    text = spoilt(texts, generator)
    spec = read_spec(parse(text.encode("utf-8", "surrogatepass"), "spec.yaml"))
    if generator.random() < BUILT:
        read_spec(parse(mimoc.build(spec).files["resolved.yaml"], "resolved.yaml"))


def spoilt(texts: list[str], generator: np.random.Generator) -> str:
    lines = pick(generator, texts).splitlines()
    for _ in range(pick(generator, (1, 1, 2, 3))):
        _spoil(lines, generator)
    return "\n".join(lines) + "\n"


def _spoil(lines: list[str], generator: np.random.Generator) -> None:
    at = generator.integers(len(lines))
    key, colon, value = lines[at].partition(":")
    match pick(generator, ("value", "number", "number", "number", "key", "line", "cut")):
        case "value":
            lines[at] = f"{key}{colon} {pick(generator, STRANGE)}"
        case "number":
            far = pick(generator, (0.1, 0.3, 3.0))
            lines[at] = (
                key + colon + NUMBER.sub(lambda word: f"{float(word[0]) * generator.lognormal(0, far):.4g}", value)
            )
        case "key":
            margin = " " * pick(generator, (0, 2, 4))
            lines.insert(at, f"{margin}{pick(generator, KEYS)}: {pick(generator, STRANGE)}")
        case "line":
            lines.insert(at, lines.pop(generator.integers(len(lines))))
        case "cut":
            middle = generator.integers(len(lines[at]) + 1)
            lines[at] = lines[at][:middle] + pick(generator, STRANGE)[:20] + lines[at][middle + generator.integers(5) :]


FUZZER = Fuzzer(prepare, attempt, short=60)
