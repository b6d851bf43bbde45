"""Scenes with MIMo in them that are changed by chance: the scene, MIMo, or all else of MIMo."""

from pathlib import Path

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_xml, pick
from support.mimo_scenes import build_mimo, write_scene

from mimoc.compat import import_config
from mimoc.compat.import_mimo.reading import read_scene
from mimoc.schema import read_spec, source

SECTIONS = """
  <equality><weld body1="mimo_location"/><joint joint1="robot:left_elbow" polycoef="-.4 0 0 0 0"/></equality>
  <sensor><touch name="more" site="torque_ub"/></sensor>"""


def prepare(folder: Path) -> list[dict[str, str]]:
    path = write_scene(folder / "parts", build_mimo(6), sections=SECTIONS)
    one = {path.name: read_scene(path).xml()}
    for part in (path.parent / "mimo").iterdir():
        part.write_text(read_scene(part).xml())
    names = (path.name, "mimo/meta.xml", "mimo/model.xml")
    return [one, {name: (path.parent / name).read_text() for name in names}]


def attempt(prepared: list[dict[str, str]], generator: np.random.Generator, folder: Path) -> None:
    scene = dict(pick(generator, prepared))
    name = pick(generator, sorted(scene))
    scene[name] = changed_xml(generator, scene[name])
    for file, text in scene.items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_text(text, errors="surrogateescape")
    result = import_config("mimo", folder / "nursery.xml")
    read_spec(source.parse(result.text, "spec.yaml"))
    assert result.scene is not None
    assert "spec_scene.xml" in result.scene("spec")


FUZZER = Fuzzer(prepare, attempt, short=20)
