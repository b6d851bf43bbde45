"""Pages as text: what they know, maybe with physics, the program that shows it, and its style, in one file."""

import base64
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import takewhile
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import SpecError
from mimoc.base.rounding import rounded
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model, mjcf_of
from mimoc.bundle.variants import Variant
from mimoc.bundle.world import WorldBundle, load_world_model
from mimoc.compiler.building import build
from mimoc.compiler.variants import SpecVariants, spec_of
from mimoc.runtime.infant import Infant
from mimoc.schema.infant import InfantSpec
from mimoc.version import __version__
from mimoc.viewer.appearance import (
    coloured_faces,
    describe_face,
    describe_materials,
    describe_skins,
    describe_surroundings,
    skin_of,
)
from mimoc.viewer.encoding import EncodedArrays, built, compressed, source
from mimoc.viewer.growth import (
    AGES_MONTHS,
    SKIN_AGES_MONTHS,
    describe_growth,
    describe_standards,
    describe_touch,
    own_parts,
    posed,
)

ENGINE, WASM = "mujoco.js", "mujoco.wasm.gz"
PHYSICS_AGES_MONTHS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 15.0, 18.0, 24.0)
"""Ages that a page has models of, besides the infant's own."""
SHOWN_ONLY = ("material", "texture", "skin")  # Elements of MJCF that physics does not need.


def describe_physics(variants: Sequence[Variant]) -> dict[str, Any]:
    """Return the models of an infant at some ages as MJCF, and what of them is the infant's."""
    model, manifest = variants[0].model, variants[0].bundle.manifest
    parts = own_parts(model, manifest)
    return {
        "models": [_model(variant) for variant in variants],
        "bodies": parts.bodies,
        "qpos": parts.qpos,
        "around": [model.body(body).name for body in range(model.nbody)],
        "step_s": manifest.step_ms / 1000,
        "commanded": np.array(
            [model.actuator(one.name).id for one in manifest.actuation.actuators if one.commanded], int
        ),
    }


def _model(variant: Variant) -> dict[str, Any]:
    scene, files = mjcf_of(variant.bundle.files, variant.bundle.manifest.scene)
    bare = {name: _bare(content.decode()) for name, content in files.items() if name.endswith(".xml")}
    needed = {name: bare.get(name, files[name]) for name in files if name.endswith((".xml", ".obj", ".stl", ".msh"))}
    return {"age_months": variant.bundle.manifest.child.age_months, "scene": _bare(scene), "files": needed}


def _bare(mjcf: str) -> bytes:
    root = ElementTree.fromstring(mjcf)
    for parent in list(root.iter()):
        parent.attrib.pop("material", None)
        parent[:] = [child for child in parent if child.tag not in SHOWN_ONLY]
    return ElementTree.tostring(root)


Progress = Callable[[int, int], None]
PROGRAM, LICENCES = "viewer.js", "LICENCES.txt"
PLACE = re.compile(r"\{\{([a-z]+)\}\}")  # Where something goes in the frame.


def page_of(infant: Bundle, physics: bool = False, progress: Progress = lambda *_: None) -> str:
    """Return the page of an infant: HTML that any browser opens from disk.

    With *physics* it contains MuJoCo, so that the infant can fall, be pulled and act.

    Raises:
        BundleError: If the bundle does not contain its spec.
        MimocError: If it has other parts at other ages.
    """
    built(PROGRAM)
    return fill(describe(infant, physics, progress))


def describe(infant: Bundle, physics: bool = False, progress: Progress = lambda *_: None) -> dict[str, Any]:
    """Return what a page knows of an infant: see `page_of`."""
    spec = spec_of(infant)
    at, grown, shown_months = _grown(spec, progress)
    sparse = [at(age, True) for age in SKIN_AGES_MONTHS]
    manifest = infant.manifest
    shown = at(manifest.child.age_months, True)
    simulated_months = sorted({*PHYSICS_AGES_MONTHS, manifest.child.age_months}) if physics else []
    simulated = [at(age, age in SKIN_AGES_MONTHS) for age in simulated_months]
    model, data, face = shown.model, posed(shown), manifest.face
    return {
        "name": manifest.name,
        "version": __version__,
        "age_months": manifest.child.age_months,
        "sex": manifest.child.sex,
        "pose": manifest.pose,
        "bounds": _bounds(*shown_months),
        "groups": manifest.anatomy.groups,
        "trunk": manifest.anatomy.trunk,
        "faces": face
        and {
            "geom": face.geom,
            "materials": {name: model.material(material).id for name, material in face.materials.items()},
            "shown": spec.body.expression,
            "shapes": describe_face(sparse, SKIN_AGES_MONTHS),
        },
        **describe_growth(grown, AGES_MONTHS),
        "standards": describe_standards([variant.bundle.manifest.child for variant in grown]),
        "touch": describe_touch(sparse, SKIN_AGES_MONTHS),
        "skins": describe_skins(sparse, SKIN_AGES_MONTHS),
        **describe_materials(model),
        "physics": describe_physics(simulated) if physics else None,
        "surroundings": describe_surroundings(model, data, own_parts(model, manifest)),
    }


NOW = "now"  # The pose that an environment is in, on its page.


def with_posture(
    about: dict[str, Any], packed: EncodedArrays, qpos: npt.NDArray[np.float64], length_cm: float
) -> dict[str, Any]:
    """Return what a page knows of an infant that is in a posture now; at other ages the same, as high as it is long."""
    lengths_cm = packed.arrays[about["standards"]["charts"]["length_cm"]["plot"]["lines"][-1]["y"]["array"]]
    posture = np.tile(qpos, (len(lengths_cm), 1))
    posture[:, 2] *= lengths_cm / length_cm
    return {**about, "poses": {**about["poses"], NOW: packed.put(posture)}, "pose": NOW}


At = Callable[[float, bool], Variant]  # Builds an infant at an age in months, dressed or not.
Range = tuple[float, float]


def _grown(spec: InfantSpec, progress: Progress) -> tuple[At, list[Variant], Range]:
    """Return what builds an infant at the ages of a page, the infant at all of them, and within which there is one.

    Where its task or what lies around does not suit some ages, it is alone. At ages at which there is no such child at
    all, it is as at the nearest one at which there is: before term, or where a contracture leaves a joint no range.
    """
    build = _builder(spec)
    ages = _lasting(build, spec)
    if ages != (spec.earliest_months, AGES_MONTHS[-1]):
        toys = {"count": [0, 0]} if spec.scene.kind == "room" else None
        alone = spec.with_(task=None, scene={"toys": toys, "objects": (), "start_at": None, "caregiver": None})
        if alone != spec:
            return _grown(alone, progress)

    def at(age_months: float, dressed: bool) -> Variant:
        return build(min(max(age_months, ages[0]), ages[1]), dressed)

    grown = list[Variant]()
    for age in AGES_MONTHS:
        progress(len(grown), len(AGES_MONTHS))
        grown.append(at(age, age in SKIN_AGES_MONTHS))
    return at, grown, ages


def _lasting(build: At, spec: InfantSpec) -> Range:
    """Return between which ages around its own an infant can be built; of those between a page's, its own counts."""

    def exists(age_months: float) -> bool:
        try:
            build(age_months, age_months in SKIN_AGES_MONTHS)
        except SpecError:
            return False
        return True

    own, first = rounded(spec.age_months), spec.earliest_months
    younger = takewhile(exists, (max(age, first) for age in reversed(AGES_MONTHS) if age < own))
    older = takewhile(exists, (age for age in AGES_MONTHS if age > own))
    return min((own, *younger)), max((own, *older))


def _bounds(least: float, most: float) -> str:
    """Return what a page says of the ages at which there is no such child, if there are any."""
    beyond = [f"before {least:g} months"] if least > AGES_MONTHS[0] else []
    beyond += [f"after {most:g} months"] if most < AGES_MONTHS[-1] else []
    text = " or ".join(beyond)
    return f"There is no such child {text}; it is shown as it is then." if beyond else ""


def fill(data: dict[str, Any], packed: EncodedArrays | None = None) -> str:
    """Return the page that shows some data; MimocError if the program of the page, or MuJoCo's, is not built."""
    parts = (packed or EncodedArrays()).encode(data)
    licences = built(LICENCES).decode()
    if data["physics"]:
        # MuJoCo's program makes functions of text when it starts; without physics, a page forbids itself that.
        wasm = base64.b64encode(built(WASM)).decode()
        parts |= {"eval": " 'unsafe-eval'", "engine": built(ENGINE).decode(), "wasm": wasm}
        licences += "\n\n" + source("mujoco_licences.txt")
    parts |= {
        "title": _escaped(str(data["name"])),
        "bounds": _escaped(data["bounds"]),
        "style": source("style.css"),
        "licences": _escaped(licences),
        "program": compressed(built(PROGRAM)),
    }
    parts = {name: part.replace("</script", "<\\/script") for name, part in parts.items()}
    return PLACE.sub(lambda place: parts.get(place[1], ""), source("page.html"))


def _builder(spec: InfantSpec) -> At:
    """Return what builds the infant of a spec at an age, once, with touch so that its skin points can be shown.

    Undressed, without the smooth skin of its spec, it takes half the time.
    """
    spec = spec if spec.senses.touch else spec.with_(senses={"touch": {}})
    seen = {"senses": {"vision": {"body": "solids"}}} if spec.senses.vision else {}
    variants = {True: SpecVariants(spec), False: SpecVariants(spec.with_(body={"skin": False}, **seen))}
    return cache(lambda age_months, dressed: variants[dressed](age_months, spec.scene.seed))


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


COLOURS = 12  # Most colours of the skin of an infant around another one: faces of each are a mesh of their own.
FloatArray = npt.NDArray[np.float64]
Place = tuple[FloatArray, FloatArray]  # A place in [m], shape (3,), and an orientation as a quaternion, shape (4,).


def page_of_world(world: WorldBundle, progress: Progress = lambda done, total: None) -> str:
    """Return the page of a world as all start there.

    Each infant is shown where it is alone, and the others are around it as they are around it in the world.

    Raises:
        BundleError: If the bundle does not contain the specs of its infants.
        MimocError: If an infant has other parts at other ages.
    """
    model, data = _start(world)
    return _page(world.manifest.name, {name: (one, model, data) for name, one in world.infants.items()}, progress)


def page_of_infants(name: str, infants: Mapping[str, Infant], progress: Progress = lambda done, total: None) -> str:
    """Return the page of the infants of an environment as they are now; see `page_of_world`.

    Of more than `MAX_SHOWN`, it shows the first ones.
    """
    shown = {called: (one.bundle, one.model, one.data) for called, one in [*infants.items()][:MAX_SHOWN]}
    return _page(name, shown, progress, is_now=True)


MAX_SHOWN = 8  # Infants of a vector environment that a page shows.


def _page(
    name: str,
    infants: Mapping[str, tuple[Bundle, mujoco.MjModel, mujoco.MjData]],
    progress: Progress,
    *,
    is_now: bool = False,
) -> str:
    packed = EncodedArrays()
    known = dict[int, tuple[Bundle, Any]]()
    about = dict[str, Any]()
    for number, (called, (infant, model, data)) in enumerate(infants.items()):
        if id(infant) not in known:

            def report(done: int, total: int, first: int = number) -> None:
                progress(first * total + done, len(infants) * total)

            alone = build(spec_of(infant)) if infant.manifest.prefix else infant
            known[id(infant)] = alone, packed.put(describe(alone, progress=report))
        alone, described = known[id(infant)]
        own = own_parts(model, infant.manifest)
        home = move_home(alone, infant, model)
        around = describe_surroundings(model, data, own)
        _add_skins(around, model, data, own.bodies)
        move_bodies(around["bodies"], home)
        about[called] = {**described, **with_surroundings(described, around, model), "name": called}
        if is_now:
            qpos = data.qpos[own.qpos]
            qpos[:3], qpos[3:7] = composed(home, (qpos[:3].copy(), qpos[3:7].copy()))
            about[called] = with_posture(about[called], packed, qpos, infant.manifest.child.length_cm)
    return fill({"name": name, "bounds": "", "physics": None, "infants": about}, packed)


def _start(world: WorldBundle) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = load_world_model(world)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(world.manifest.pose).id)
    mujoco.mj_forward(model, data)
    return model, data


def move_bodies(bodies: dict[str, Any], move: Place) -> None:
    """Move the bodies of surroundings."""
    moved = [composed(move, place) for place in zip(bodies["pos"], bodies["quat"], strict=True)]
    bodies["pos"], bodies["quat"] = (np.array(parts) for parts in zip(*moved, strict=True))


def move_home(alone: Bundle, infant: Bundle, model: mujoco.MjModel) -> Place:
    """Return what brings an infant from where it starts in its world to where it starts alone."""
    bare = load_model(alone)
    starts = [
        one.key(bundle.manifest.pose).qpos[own_parts(one, bundle.manifest).qpos[:7]]
        for one, bundle in ((bare, alone), (model, infant))
    ]
    (to_m, to), (from_m, start) = ((root[:3], root[3:]) for root in starts)
    back, turn, offset_m = np.empty(4), np.empty(4), np.empty(3)
    mujoco.mju_negQuat(back, start)
    mujoco.mju_mulQuat(turn, to, back)
    mujoco.mju_rotVecQuat(offset_m, from_m, turn)
    return to_m - offset_m, turn


def composed(move: Place, place: Place) -> Place:
    """Return a place after a move."""
    offset_m, turned = np.empty(3), np.empty(4)
    mujoco.mju_rotVecQuat(offset_m, place[0], move[1])
    mujoco.mju_mulQuat(turned, move[1], place[1])
    return move[0] + offset_m, turned


def _add_skins(around: dict[str, Any], model: mujoco.MjModel, data: mujoco.MjData, own: npt.NDArray[np.intp]) -> None:
    """Add the skins of other infants as they are now, as meshes of a few colours on the world's body."""
    bodies, geoms = around["bodies"], around["geoms"]
    world = len(bodies["names"])
    bodies["names"].append("skins of the others")
    bodies["pos"] = np.concatenate([bodies["pos"], np.zeros((1, 3))])
    bodies["quat"] = np.concatenate([bodies["quat"], [[1.0, 0.0, 0.0, 0.0]]])
    for index in range(model.nskin):
        if skin_of(model, index).bodies[0] in own:
            continue
        for rgba, verts_m, faces in _skin_meshes(model, data, index):
            geoms["names"].append(model.skin(index).name)
            added = {"body": world, "type": mujoco.mjtGeom.mjGEOM_MESH, "material": -1, "mesh": len(around["meshes"])}
            added |= {"rgba": rgba, "pos": np.zeros(3), "quat": np.array([1.0, 0, 0, 0]), "size": np.ones(3)}
            for name, value in added.items():
                geoms[name] = np.concatenate([geoms[name], np.array([value], geoms[name].dtype)])
            around["meshes"].append({"verts": verts_m, "faces": faces})


def _skin_meshes(
    model: mujoco.MjModel, data: mujoco.MjData, index: int
) -> Iterator[tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[np.uint32]]]:
    """Yield the colours of a skin, each with the vertices in the world and the faces that have it."""
    skin = skin_of(model, index)
    verts_m = np.zeros_like(skin.vertices_m)
    for bone, body in enumerate(skin.bodies):
        bound = np.empty(9)
        mujoco.mju_quat2Mat(bound, skin.bind_quat[bone])
        turn = data.xmat[body].reshape(3, 3) @ bound.reshape(3, 3).T
        verts_m += skin.weights[:, bone, None] * ((skin.vertices_m - skin.bind_pos[bone]) @ turn.T + data.xpos[body])
    for colour, faces in coloured_faces(model, index, COLOURS):
        used, renumbered = np.unique(faces, return_inverse=True)
        yield np.array([*colour, 255]) / 255, verts_m[used], renumbered.reshape(-1, 3).astype(np.uint32)


def with_surroundings(about: Mapping[str, Any], around: dict[str, Any], model: mujoco.MjModel) -> dict[str, Any]:
    """Return surroundings with materials and pictures of their own, behind those of the infant."""
    described = describe_materials(model)
    numbers = around["geoms"]["material"]
    used = sorted({int(number) for number in numbers if number >= 0})
    materials, textures = [*about["materials"]], [*about["textures"]]
    for number in used:
        material = dict(described["materials"][number])
        if material["texture"] is not None:
            textures.append(described["textures"][material["texture"]])
            material["texture"] = len(textures) - 1
        materials.append(material)
    first = len(about["materials"])
    around["geoms"]["material"] = np.array([first + used.index(item) if item >= 0 else -1 for item in numbers], int)
    return {"materials": materials, "textures": textures, "surroundings": around}
