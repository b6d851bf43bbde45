"""Policies that are changed by chance: their archive, their members, and what is in these."""

import io
import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from fuzz.crafted_policies import Members, packed, ran, unpacked
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_bytes, changed_data, pick

import mimoc

SPEC = {
    "mimoc": 1,
    "name": "reaching",
    "age_months": 18,
    "senses": {"proprioception": {}},
    "task": {"kind": "reach", "steps": 30},
}
TINY = {"n_steps": 32, "batch_size": 64, "n_epochs": 1, "width": 8, "layers": 1}


def prepare(folder: Path) -> tuple[Members, Any]:
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(SPEC))
    mimoc.train(bundle, folder / "run", steps=64, envs=2, checkpoint_every=64, hyper=TINY)
    return unpacked((folder / "run/policy.zip").read_bytes()), mimoc.InfantEnv(bundle)


def attempt(prepared: tuple[Members, Any], generator: np.random.Generator, folder: Path) -> None:
    members, env = prepared
    content = _spoiled(dict(members), generator)
    (folder / "policy.zip").write_bytes(content)
    try:
        use(folder / "policy.zip", env)
    finally:
        assert not ran(), "code of the policy has run"


def use(policy: Path, env: Any) -> None:
    act = mimoc.load_policy(policy)(env)
    observation, _ = env.reset(seed=1)
    for _ in range(2):
        observation, *_ = env.step(act(np.random.default_rng(0), observation))


def _spoiled(members: Members, generator: np.random.Generator) -> bytes:
    kind = int(generator.integers(6))
    if kind == 0:
        return changed_bytes(generator, packed(members, pick(generator, (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))))
    if kind == 1:
        name, other = (pick(generator, ["mimoc.json", "scale.npz", "weights.npz"]) for _ in range(2))
        members[name] = members[other]
    elif kind == 2:
        data = changed_data(generator, json.loads(members["mimoc.json"]))
        members["mimoc.json"] = json.dumps(data).encode(errors="surrogateescape")
    elif kind == 3:
        name = pick(generator, ["mimoc.json", "scale.npz", "weights.npz"])
        members[name] = changed_bytes(generator, members[name])
    else:
        _spoil_within(members, generator, pick(generator, ["scale.npz", "weights.npz"]))
    return packed(members)


def _spoil_within(members: Members, generator: np.random.Generator, name: str) -> None:
    inner = unpacked(members[name])
    inside = pick(generator, sorted(inner))
    inner[inside] = changed_bytes(generator, inner[inside])
    with zipfile.ZipFile(io.BytesIO(members[name])) as archive:
        compression = archive.infolist()[0].compress_type
    members[name] = packed(inner, compression)


FUZZER = Fuzzer(prepare, attempt, short=60)
