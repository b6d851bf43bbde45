"""Conversion of MIMo's scenes, and of users' scenes with MIMo in them, into a spec and a scene for its infant."""

import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import mujoco

from mimoc.base.errors import MimocError, Problem, SpecError
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import mjcf_of
from mimoc.compat.import_mimo.comparison import names_in_model, notes_on_infant, recognise_age
from mimoc.compat.import_mimo.infant import (
    Infant,
    find_infant,
    locked_groups,
    notes_on_surroundings,
    read_actuation,
    read_body,
    read_senses,
    read_surroundings,
)
from mimoc.compat.import_mimo.reading import AssetFiles, Element, check_limits, read_scene, without_pictures
from mimoc.compat.import_mimo.rest import MODEL, Rest, moved_keyframes, rest_of
from mimoc.compat.settings import Imported, infant_name
from mimoc.compiler.building import build
from mimoc.schema.infant import InfantSpec

INFANT = "infant.xml"
_LINE = re.compile(r",? line (\d+)")  # Where MuJoCo says that an error is: in the text of all that a scene includes.
HEADING = "<!-- The scene that `mimoc import mimo` read, with the infant of a bundle: build that first. -->\n"


def import_mimo(path: str | Path) -> Imported:
    """Convert a scene with MIMo, in MJCF, into a spec, and a scene in which the infant of the spec takes MIMo's place.

    Raises a SpecError with all problems of a kind if a file cannot be read, or MuJoCo or mimoc cannot use it.
    """
    path = Path(path)
    tree = read_scene(path)
    check_limits(tree)
    infant = find_infant(tree, str(path))
    assets = AssetFiles(tree, path.parent)
    model = _compiled(assets.moved(without_pictures(tree)), assets.files, str(path))
    age = recognise_age(model, infant.anatomy)
    head = {"mimoc": 1, "name": infant_name(path.stem, "mimo"), "age_months": age.months, "development": "published"}
    sections = {
        "body": read_body(infant),
        "actuation": read_actuation(infant, model),
        "senses": read_senses(model),
        **read_surroundings(infant, model),
    }
    if "task" in sections:
        sections["actuation"] = {name: value for name, value in sections["actuation"].items() if name == "model"}
    spec = head | {name: section for name, section in sections.items() if section}
    bundle = _built(spec, path)
    mimocs = mujoco.MjModel.from_xml_string(*mjcf_of(bundle.files, INFANT))
    names = names_in_model(mimocs)
    rest = rest_of(infant, model, bundle.files[INFANT], mimocs, names)
    pictured = AssetFiles(tree, path.parent)
    pictured.moved(rest.tree)
    scene = partial(_scene_files, rest, pictured, spec["name"])
    whole = _opened(scene("spec"), bundle, spec["name"], path)
    if model.nkey:
        rest.tree.children.append(moved_keyframes(infant, model, whole))
        _opened(scene("spec"), bundle, spec["name"], path)
    texts = (*_notes_on_locks(infant, spec), *notes_on_surroundings(spec))
    on_scene = [Problem(str(path), tree.line, 1, tree.tag, text) for text in texts]
    notes = (*notes_on_infant(infant, age, model, mimocs, names), *on_scene, *rest.notes)
    sources = {Path(element.file).resolve() for element in tree.walk()} | pictured.sources
    return Imported("MIMo", str(path), spec, tuple(sorted(notes)), scene, frozenset(sources))


def _built(spec: dict[str, Any], path: Path) -> Bundle:
    try:
        return build(InfantSpec(**spec))
    except SpecError as error:
        raise SpecError(
            Problem(str(path), 1, 1, problem.key, f"the spec of this scene cannot be built: {problem.message}")
            for problem in error.problems
        ) from None
    except MimocError as error:
        raise SpecError([Problem(str(path), 1, 1, "", f"the spec of this scene cannot be built: {error}")]) from None


def _compiled(tree: Element, files: Mapping[str, bytes], file: str) -> mujoco.MjModel:
    try:
        with _unheard():
            return mujoco.MjModel.from_xml_string(tree.xml(), dict(files))
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        message = f"MuJoCo {mujoco.__version__} rejects this scene: {' '.join(_LINE.sub('', str(error)).split())}"
        line = _LINE.search(str(error))
        element = next(islice(tree.lines(), int(line[1]) - 1, None), None) if line else None
        problem = element.problem(message) if element and element.line else Problem(file, 1, 1, "", message)
        raise SpecError([problem]) from None


def _notes_on_locks(infant: Infant, spec: dict[str, Any]) -> list[str]:
    partly = [group for group, wholly in locked_groups(infant).items() if not wholly]
    notes = [f"some joints of {', '.join(partly)} are locked; a spec locks whole muscle groups"] if partly else []
    if "locked" in spec.get("actuation", {}):
        notes.append("the spec locks joints at the angles of its pose, the scene beside it at its own")
    return notes


def _scene_files(rest: Rest, assets: AssetFiles, name: str, stem: str) -> dict[str, bytes]:
    """Return the scene and its assets, by path relative to the folder of a spec whose file has this stem."""
    folder = f"{stem}_assets/"
    tree = assets.moved(rest.tree, folder)
    infant = Element("asset", {}, children=[Element("model", {"name": MODEL, "file": f"out/{name}/{INFANT}"})])
    tree.children.insert(0, infant)
    scene = {f"{stem}_scene.xml": (HEADING + tree.xml()).encode()}
    return scene | {folder + file: content for file, content in assets.files.items()}


def _opened(files: Mapping[str, bytes], bundle: Bundle, name: str, path: Path) -> mujoco.MjModel:
    """Return a scene with the infant of its spec, opened by MuJoCo from files like those that will be written."""
    with tempfile.TemporaryDirectory() as folder:
        of_bundle = {f"out/{name}/{file}": content for file, content in bundle.files.items()}
        for file, content in {**files, **of_bundle}.items():
            (Path(folder) / file).parent.mkdir(parents=True, exist_ok=True)
            (Path(folder) / file).write_bytes(content)
        try:
            with _unheard():
                return mujoco.MjModel.from_xml_path(str(Path(folder) / next(iter(files))))
        except (ValueError, RuntimeError, mujoco.FatalError) as error:
            reason = " ".join(str(error).replace(folder, "").split())
            message = f"MuJoCo {mujoco.__version__} rejects what is left of this scene with mimoc's infant: {reason}"
            raise SpecError([Problem(str(path), 1, 1, "", message)]) from None


@contextmanager
def _unheard() -> Iterator[None]:
    """Keep MuJoCo from printing its warnings, and writing them to a file, MUJOCO_LOG.TXT, in the current folder."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda message: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
