"""The page of a world: a page of each infant in it, with the others around it, of which one is shown at a time."""

from collections.abc import Iterator, Mapping
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.bundle.world import WorldBundle, load_world_model
from mimoc.compiler.pipeline import build
from mimoc.compiler.variants import spec_of
from mimoc.runtime.infant import Infant
from mimoc.viewer.appearance import describe_materials, describe_surroundings
from mimoc.viewer.encoding import EncodedArrays
from mimoc.viewer.growth import own_parts
from mimoc.viewer.meshes import coloured_faces, skin_of
from mimoc.viewer.page import Progress, describe, fill, with_posture

COLOURS = 12
"""Of the picture on a skin of an infant that is around another one: faces of each are a mesh of their own."""
FloatArray = npt.NDArray[np.float64]
Place = tuple[FloatArray, FloatArray]
"""A place in [m], shape (3,), and an orientation as a quaternion, shape (4,)."""


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

    Of more than `MOST_SHOWN`, it shows the first ones.
    """
    shown = {called: (one.bundle, one.model, one.data) for called, one in [*infants.items()][:MOST_SHOWN]}
    return _page(name, shown, progress, is_now=True)


MOST_SHOWN = 8
"""Infants of a vector environment that a page shows."""


def _page(
    name: str,
    infants: Mapping[str, tuple[Bundle, mujoco.MjModel, mujoco.MjData]],
    progress: Progress,
    *,
    is_now: bool = False,
) -> str:
    packed, known, about = EncodedArrays(), dict[int, tuple[Bundle, Any]](), dict[str, Any]()
    for number, (called, (infant, model, data)) in enumerate(infants.items()):
        if id(infant) not in known:

            def report(done: int, total: int, first: int = number) -> None:
                progress(first * total + done, len(infants) * total)

            alone = build(spec_of(infant)) if infant.manifest.prefix else infant
            known[id(infant)] = alone, packed.put(describe(alone, progress=report))
        alone, described = known[id(infant)]
        own, home = own_parts(model, infant.manifest), move_home(alone, infant, model)
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
    described, numbers = describe_materials(model), around["geoms"]["material"]
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
