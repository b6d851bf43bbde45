"""Skills, results of the benchmark and folders of filmed children that are changed by chance."""

import json
import shutil
from collections.abc import Mapping
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_bytes, changed_data, pick
from support.motions import moved, retargeted

import mimoc
from mimoc.bundle.io import pack_arrays, unpack_arrays
from mimoc.movement.retargeting.folder import ACCOUNT, FITTED, POINTS, write_retargeted
from mimoc.policies.named import policy_of
from mimoc.policies.skill import shipped
from mimoc.studies.bench.scores import check_files, markdown_tables, read_results

SPEC = {
    "mimoc": 1,
    "name": "kim",
    "age_months": 4,
    "scene": {"kind": "flat", "pose": "supine"},
    "senses": {"proprioception": {"include": ["velocity"]}, "vestibular": {}},
}


@dataclass(frozen=True)
class Prepared:
    env: Any
    skill: Mapping[str, Any]
    results: Mapping[str, Any]
    child: Path  # The folder of a filmed child.


def prepare(folder: Path) -> Prepared:
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(SPEC))
    results = mimoc.run_bench("zero", folder / "zero.json", tasks=["grasp"], ages_months=[12], episodes=1)
    child = write_retargeted(retargeted(bundle, moved(bundle, 0.3)), folder / "child")
    skill = json.loads(shipped()["roll", 4.0].read_text())
    return Prepared(mimoc.make(bundle).unwrapped, skill, results.model_dump(mode="json"), child)


def attempt(prepared: Prepared, generator: np.random.Generator, folder: Path) -> None:
    kind = pick(generator, ["skill", "results", "child"])
    if kind == "skill":
        _write(folder / "skill.json", generator, prepared.skill)
        _act(prepared.env, f"skill:{folder}/skill.json")
    elif kind == "results":
        _write(folder / "results.json", generator, prepared.results)
        results = read_results(folder / "results.json")
        assert len(markdown_tables([results]).splitlines()) == 7 + len(results.cells)
        with chdir(folder):
            check_files(results.policy, [results.policy], results.policy_files)
    else:
        shutil.copytree(prepared.child, folder / "child")
        _change_child(folder / "child", generator)
        mimoc.read_retargeted(folder / "child")
        _act(prepared.env, f"motion:{folder}/child")


def _write(path: Path, generator: np.random.Generator, data: Any) -> None:
    content = json.dumps(changed_data(generator, data)).encode(errors="surrogateescape")
    path.write_bytes(changed_bytes(generator, content) if generator.random() < 0.2 else content)


def _change_child(folder: Path, generator: np.random.Generator) -> None:
    name = pick(generator, ["motion.npz", "motion.npz", POINTS, FITTED, ACCOUNT, "recording.json"])
    path = folder / name
    if name.endswith(".json"):
        _write(path, generator, json.loads(path.read_text()))
    elif generator.random() < 0.3:
        path.write_bytes(changed_bytes(generator, path.read_bytes()))
    else:
        arrays = {key: np.array(array) for key, array in unpack_arrays(path.read_bytes()).items()}
        key = pick(generator, sorted(arrays))
        if arrays[key].dtype.kind == "f" and arrays[key].size:
            first = int(generator.integers(arrays[key].size))
            arrays[key].flat[first : first + 4] = pick(generator, [0.0, np.nan, np.inf, -1e300, 1e9, 7.0])
        path.write_bytes(pack_arrays(arrays))


def _act(env: Any, policy: str) -> None:
    act = policy_of(env, policy)
    observation, _ = env.reset(seed=1)
    for _ in range(2):
        observation, *_ = env.step(act(np.random.default_rng(0), observation))


FUZZER = Fuzzer(prepare, attempt, short=60)
