"""Cohorts that anyone might write, drawn from the JSON Schema, and put through every command that is for them."""

import contextlib
import io
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import OMITTED, Drawing, Hints, among, between, pick, whole

import mimoc
from mimoc import cli
from mimoc.base.errors import MimocError, SpecError
from mimoc.base.quantities import measures
from mimoc.policies.named import policy_of
from mimoc.policies.spec import needs_argument
from mimoc.schema.infant import read_spec
from mimoc.schema.json_schema import json_schema
from mimoc.schema.kinds import ENGINES, POLICIES, EngineKind
from mimoc.schema.source import dump, in_memory
from mimoc.studies.cohorts import cohort as cohorts
from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.infants import children_of
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.run_jobs import run_jobs
from mimoc.studies.cohorts.store import Result, Store
from mimoc.training.settings import check_learnable

MAX_INFANTS = 4
TRIES = 1000  # Cohorts that are drawn until one is valid.
ENGINE = "here"  # Name of this module as an engine.
NAMED = tuple(name for name, kind in POLICIES.items() if not needs_argument(kind) and name != "look_around")
"""Policies that need nothing but their name, and no sense."""
MODULE = """
def probe(work, **options):
    return {"own": float(work.seed), "text": "é", "options": len(options)}

def weigh(work):
    return work.bundle.manifest.child.weight_kg / 2
"""
TRAINING = {"steps": 64, "envs": 2, "checkpoint_every": 64}
HYPER = {
    "ppo": {"n_steps": 32, "batch_size": 32, "n_epochs": 1, "width": 8},
    "sac": {"learning_starts": 10, "width": 8},
}


def _run(generator: np.random.Generator) -> dict[str, Any]:
    step = Drawing(json_schema("cohort"), IN_COHORTS, generator).value({"$ref": "#/$defs/RunStep"})
    return {"steps": 10, **step}


def _do(generator: np.random.Generator) -> list[Any]:
    schema = json_schema("cohort")
    drawn = Drawing(schema, IN_COHORTS, generator).value(schema["properties"]["do"])
    short = {"run": _run, "train": _train}
    return [{step: short[step](generator)} if isinstance(step, str) and step in short else step for step in drawn]


def _train(generator: np.random.Generator) -> dict[str, Any]:
    algo = pick(generator, tuple(HYPER))
    return {"algo": algo, "hyper": HYPER[algo], **TRAINING}


IN_INFANTS: Hints = {
    "name": among("kim", "one_2"),
    "age_months": between(0, 24),
    "individual": lambda generator: Drawing(json_schema("cohort"), IN_COHORTS, generator).value(INDIVIDUAL),
    "steps": whole(1, 20),
    "step_ms": among(10.0, 20.0, 50.0),
    "timestep_ms": among(2.5, 5.0),
    **dict.fromkeys(("width_px", "height_px"), whole(1, 24)),
    "supersample": whole(1, 2),
    "density": between(0.2, 1),
    "count": among([0, 0], [0, 2], [1, 1]),
    "source": among("builtin"),
    **dict.fromkeys(("root", "subset", "textures"), among(OMITTED)),
    **{f"{sense}_ms": among(0.0, 50.0, 100.0) for sense in ("motor", "proprioception", "sensory", "touch")},
    **{f"{sense}_ms": among(0.0, 50.0, 200.0) for sense in ("vestibular", "vision", "delay_jitter")},
}
IN_COHORTS: Hints = {
    "base": lambda generator: infant(generator),
    "cohort": among("spring", "a1"),
    "vary": lambda generator: varied(generator),
    "draw": whole(1, 3),
    "n": whole(1, 3),
    "steps": whole(1, 20),
    "policy": lambda generator: pick(generator, NAMED),
    "seeds": among(0, [3, 1], "0:2"),
    "measure": lambda generator: [name for name in (*measures(), "own_code:weigh") if generator.random() < 0.3],
    "do": _do,
    "run": _run,
    "train": _train,
    "experiment": among(OMITTED),
    "function": among("own_code:probe"),
    "python": among("own_code:probe", {"function": "own_code:probe", "seeds": 3, "options": {"x": 1, "y": "z"}}),
    **dict.fromkeys(("length_cm",), between(50, 90)),
    **dict.fromkeys(("head_circumference_cm",), between(35, 50)),
    **dict.fromkeys(("weight_kg",), between(3, 13)),
    **{f"{what}_percentile": between(1, 99) for what in ("length", "weight", "head")},
}
INDIVIDUAL = {"$ref": "#/$defs/IndividualSpec"}


def infant(generator: np.random.Generator) -> dict[str, Any]:
    data = Drawing(json_schema("infant"), IN_INFANTS, generator).value()
    for _ in range(20):
        try:
            read_spec(in_memory(data, "<spec>", Path()))
        except SpecError as error:
            for problem in error.problems:
                _remove(data, problem.key.split("."))
        else:
            break
    return data


def varied(generator: np.random.Generator) -> dict[str, Any]:
    drawing = Drawing(json_schema("infant"), IN_INFANTS, generator)
    drawn = {}
    for _ in range(generator.integers(1, 3)):
        path, node = list[str](), drawing.schema
        while "properties" in node and not (path and generator.random() < 0.1):
            path.append(pick(generator, [key for key in node["properties"] if key not in ("mimoc", "name")]))
            node = drawing.resolved(node["properties"][path[-1]])
        hint = IN_INFANTS.get(path[-1])
        values = [hint(generator) if hint else drawing.value(node) for _ in range(generator.integers(1, 4))]
        if OMITTED in values:
            continue
        numbers = [value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)]
        shape = pick(generator, ("list", "range", "draws")) if len(numbers) == len(values) > 1 else "list"
        if shape == "range" and min(numbers) < max(numbers):
            drawn[".".join(path)] = {"from": min(numbers), "to": max(numbers), "step": max(numbers) - min(numbers)}
        elif shape == "draws":
            drawn[".".join(path)] = {"uniform": sorted(numbers)[:2], "n": len(numbers), "seed": 3}
        else:
            drawn[".".join(path)] = values
    return drawn


def _remove(data: Any, keys: list[str]) -> None:
    """Remove a key, or what it is below of, if that is not there."""
    for key in keys[:-1]:
        if not isinstance(data.get(key), dict):
            break
        data = data[key]
    else:
        key = keys[-1]
    data.pop(key, None)


def valid_cohort(generator: np.random.Generator, folder: Path) -> Path:
    """Return the file of a small cohort that is valid, whose infants can be built, and can learn if they are to.

    The JSON Schema does not say which measurements fit together, or what a hand that is removed cannot hold.
    """
    (folder / "own_code.py").write_text(MODULE)
    path = folder / "cohort.yaml"
    for _ in range(TRIES):
        data = Drawing(json_schema("cohort"), IN_COHORTS, generator).value()
        if generator.random() < 0.5:
            (folder / "base.yaml").write_text(dump(data["base"]))
            data["base"] = "base.yaml"
        path.write_text(dump(data))
        with contextlib.suppress(MimocError):
            cohort = Cohort(path)
            if len(children_of(cohort.spec)) <= MAX_INFANTS and len(cohort.infants) <= MAX_INFANTS:
                check_possible(cohort)
                return path
    raise AssertionError("no valid cohort was drawn")


def check_possible(cohort: Cohort) -> None:
    """Raise a MimocError if an infant cannot be built, is to learn and cannot, or cannot follow a policy.

    Also if there is no such child from birth to 24 months, all of which pages show.
    """
    jobs = cohort.jobs()
    learning = any(job.step == "train" for job in jobs)
    policies = {job.options["policy"] for job in jobs if job.step == "run"}
    for spec in cohort.specs:
        with mimoc.InfantEnv(mimoc.build(spec)) as env:
            if learning:
                check_learnable(env)
            for policy in policies:
                policy_of(env, policy)
        child = mimoc.InfantSpec(mimoc=1, name=spec.name, age_months=spec.age_months, body=spec.body)
        for age_months in (0, 24):
            mimoc.build(child.with_(age_months=age_months))


def prepare(_: Path) -> None:
    """Return nothing: each cohort is drawn anew."""


@contextmanager
def in_this_process() -> Iterator[None]:
    """Let an engine do jobs in this process, as starting one for each cohort takes seconds."""
    ENGINES.add(EngineKind(ENGINE, (), lambda options: None, _run))
    try:
        with patch.object(cohorts, "try_out", _try_out):
            yield
    finally:
        ENGINES.remove(ENGINE)


def _try_out(jobs: Sequence[Job], store: Store, _: float) -> list[Result | None]:
    run_jobs(jobs, store)
    return [store.read(job) for job in jobs]


def _run(jobs: Any, store: Any, _: Any, done: Any) -> None:
    run_jobs(jobs, store)
    done(len(jobs))


def attempt(_: None, generator: np.random.Generator, folder: Path) -> None:
    path, out = valid_cohort(generator, folder), folder / "out"
    cohort, place = Cohort(path), ["-o", out]
    with contextlib.chdir(folder), in_this_process():
        called("cohort", "plan", path, *place)
        called("cohort", "run", path, *place, "--on", ENGINE)
        called("cohort", "status", path, *place)
        called("cohort", "table", path, *place)
        called("report", out, "-o", "cohort.html")
        called("report", out, "-o", "whole.html", "--cohort", path)
        (folder / "infant.yaml").write_text(dump(dict(pick(generator, cohort.infants).data)))
        use_infant(Path("infant.yaml"), generator)


def use_infant(spec: Path, generator: np.random.Generator) -> None:
    called("build", spec, "-o", "bundle")
    called("run", "bundle", "--steps", 3, "--record", "recording", "--seed", generator.integers(9))
    called("replay", "recording")
    called("export", "recording", "--to", "csv", "-o", "csv")
    called("report", "bundle", "-o", "infant.html")
    called("view", "recording", "-o", "recording_view.html", "--no-open")
    called("view", "bundle", "-o", "view.html", "--no-open")


def called(*arguments: object) -> str:
    """Run a command in this process, and return what it prints; unless it succeeds, raise an AssertionError."""
    words, before, printed = [*map(str, arguments)], sys.argv, io.StringIO()
    sys.argv = ["mimoc", *words]
    try:
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            cli.main()
    except SystemExit as ended:
        if ended.code:
            raise AssertionError(f"mimoc {' '.join(words)}: exit code {ended.code}: {printed.getvalue()}") from None
    except Exception:
        raise AssertionError(f"mimoc {' '.join(words)}: {traceback.format_exc()}") from None
    finally:
        sys.argv = before
    return printed.getvalue()


FUZZER = Fuzzer(
    prepare,
    attempt,
    short=1,
    longest_s=60.0,
    largest_mb=2048,  # A process has torch and OpenGL, and keeps what it has read of all infants.
    honest=True,
)
