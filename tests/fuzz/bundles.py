"""Bundles that are changed by chance and sealed anew, then opened and used."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_bytes, changed_data, changed_xml, pick
from fuzz.strange_infants import VARIATIONS, honest_files, write_resealed
from support.pages import few_ages

import mimoc
from mimoc.compiler.explain import explain
from mimoc.viewer.formatters import bundle_html
from mimoc.viewer.page import page_of

STEPS = 3


def prepare(folder: Path) -> list[dict[str, bytes]]:
    return [honest_files(number) for number in range(len(VARIATIONS))]


def attempt(prepared: list[dict[str, bytes]], generator: np.random.Generator, folder: Path) -> None:
    files = spoiled(dict(pick(generator, prepared)), generator)
    bundle = write_resealed(files, folder / "bundle")
    env = mimoc.make(bundle)
    try:
        live(env, generator)
    finally:
        env.close()
    if generator.random() < 0.2:
        pick(generator, OTHER_USES)(bundle, folder)


def live(env: Any, generator: np.random.Generator) -> None:
    env.reset(seed=1)
    for _ in range(STEPS):
        env.step(env.action_space.sample())
    infant = env.unwrapped
    for sense in infant.senses:
        infant.layout(sense)
    infant.keypoints()
    infant.set_state(infant.get_state())
    if infant.manifest.face:
        infant.set_expression(pick(generator, sorted(infant.manifest.face.materials)))
    env.reset(options={"pose": pick(generator, infant.manifest.poses)})
    if generator.random() < 0.1:
        infant.grow(to=pick(generator, (3.0, 9.5)))


OTHER_USES: tuple[Callable[[Path, Path], Any], ...] = (
    lambda bundle, folder: explain(mimoc.read_bundle(bundle), "child.length_cm"),
    lambda bundle, folder: mimoc.torque_limits(bundle),
    lambda bundle, folder: repr(mimoc.read_bundle(bundle).arrays),
    lambda bundle, folder: bundle_html(mimoc.read_bundle(bundle)),
    lambda bundle, folder: _report(bundle, folder / "report.html"),
    lambda bundle, folder: _page(mimoc.read_bundle(bundle)),
)


def _report(bundle: Path, page: Path) -> None:
    with patch("mimoc.studies.reporting.infant.introduce", lambda bundle: ((), ())):
        mimoc.report(bundle, page)


def _page(bundle: mimoc.Bundle) -> str:
    with few_ages():
        return page_of(bundle)


def spoiled(files: dict[str, bytes], generator: np.random.Generator) -> dict[str, bytes]:
    kinds = ("manifest.json",) * 4 + ("infant.xml",) * 3 + ("scene.xml",) * 3 + ("asset",) * 2 + ("other",)
    kind = pick(generator, kinds)
    if kind == "manifest.json":
        files[kind] = json.dumps(changed_data(generator, json.loads(files[kind]))).encode(errors="surrogateescape")
    elif kind.endswith(".xml"):
        files[kind] = changed_xml(generator, files[kind].decode()).encode(errors="surrogateescape")
    else:
        _spoil_file(files, generator, is_asset=kind == "asset")
    return files


def _spoil_file(files: dict[str, bytes], generator: np.random.Generator, *, is_asset: bool) -> None:
    """Change the bytes of a file, swap it with another one, or leave it out."""
    names = [name for name in sorted(files) if name.startswith("assets/") == is_asset]
    name, kind = pick(generator, names), int(generator.integers(5))
    if kind == 0:
        del files[name]
    elif kind == 1:
        files[name] = files[pick(generator, sorted(files))]
    else:
        files[name] = changed_bytes(generator, files[name])


FUZZER = Fuzzer(prepare, attempt, short=25)
