"""The bundle of a world with several infants: one model, and for each infant what the runtime knows of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal

import mujoco
import numpy as np
from pydantic import Field, ValidationError

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import BundleError
from mimoc.bundle.io import MANIFEST, Bundle, in_order, read_locked
from mimoc.bundle.manifest import Manifest, ToyEntry, read_manifest
from mimoc.bundle.model import SCENE, TOUCH_M, check_fits, check_mjcf, in_subtrees, prefixed, prepare, read_model
from mimoc.bundle.regular_files import problems_in
from mimoc.schema.base import Model, omitting
from mimoc.schema.caregiver import CaregiverEntry
from mimoc.schema.entries import ControlStep, Duration, Keyframe, Label
from mimoc.schema.objects import ObjectEntry
from mimoc.schema.world import MAX_INFANTS

INFANTS = "infants"  # Folder with a folder for each infant, by its name.
START = "start"  # Keyframe in which all infants are in the poses that their specs give.


class WorldManifest(Model):
    """All that the compiler passes on to the runtime about a world, besides its infants."""

    world: Literal[1] = 1
    """Version of this file."""
    name: Label
    """Name of the world."""
    scene: Literal["scene.xml"] = "scene.xml"
    """Entry point of the model."""
    timestep_ms: Annotated[Duration, Field(ge=0.1, le=20)]
    """Duration of a physics step."""
    step_ms: ControlStep
    """Duration of a control step, that of all infants."""
    pose: Keyframe = START
    """Keyframe that an episode starts from by default."""
    infants: Annotated[
        tuple[Annotated[Label, Field(pattern="^[a-z][a-z0-9_]*$")], ...], Field(min_length=1, max_length=MAX_INFANTS)
    ]
    """Names of the infants; the folder of each has its manifest."""
    seed: Annotated[int, Field(ge=0, le=10**30)] = 0
    """Seed of the scene."""
    toys: tuple[ToyEntry, ...] = ()
    """The toys in the scene."""
    objects: tuple[ObjectEntry, ...] = ()
    """The objects of the scene."""
    caregiver: CaregiverEntry | None = None
    """An adult by the infants; the face and the kicks in it are those of the infant that it is by."""
    notes: tuple[str, ...] = ()
    """Notes on the build for its user."""

    _serialized = omitting("caregiver")


@dataclass(frozen=True, slots=True, repr=False)
class WorldBundle:
    """The files of a compiled world with several infants.

    Example:
        >>> import mimoc
        >>> anna = mimoc.load_spec("nine_months.yaml")
        >>> world = mimoc.build_world({"anna": anna, "ben": anna.with_(age_months=12)})
        >>> world.infants["ben"].manifest.root_body, world.infants["ben"].manifest.child.age_months
        ('ben_hip', 12.0)
    """

    files: Mapping[str, bytes]  # Content of each file by its path within the bundle, sorted; read-only.
    manifest: WorldManifest  # What the runtime knows about the world.
    infants: Mapping[str, Bundle]  # What it knows about each infant, by name: a bundle without MJCF of its own.
    path: Path | None  # Folder it was read from; None if it exists only in memory.

    def __repr__(self) -> str:
        return f"WorldBundle({self.manifest.name!r}, {', '.join(self.infants)})"

    def __reduce__(self) -> tuple[Any, ...]:
        manifests = {name: bundle.manifest for name, bundle in self.infants.items()}
        return world_bundle, (dict(self.files), self.manifest, manifests, self.path)


def world_bundle(
    files: Mapping[str, bytes], manifest: WorldManifest, manifests: Mapping[str, Manifest], path: Path | None = None
) -> WorldBundle:
    """Return a world of files and what their manifests say."""
    infants = {
        name: Bundle(in_order(files_of(name, files)), manifests[name], path and path / INFANTS / name)
        for name in manifest.infants
    }
    return WorldBundle(in_order(files), manifest, MappingProxyType(infants), path)


def manifests_of(bundle: Bundle | WorldBundle) -> Mapping[str, Manifest]:
    """Return the manifests of the infants of a world, by name, or that of an infant that is alone, named ""."""
    if isinstance(bundle, WorldBundle):
        return {name: infant.manifest for name, infant in bundle.infants.items()}
    return {"": bundle.manifest}


def file_of(infant: str, name: str) -> str:
    """Return the path of a file of an infant within the bundle of its world."""
    return f"{INFANTS}/{infant}/{name}"


def files_of(infant: str, files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the files of an infant among those of its world, by their paths within the infant's own bundle."""
    start = file_of(infant, "")
    return {path.removeprefix(start): content for path, content in files.items() if path.startswith(start)}


def is_world_folder(path: str | Path) -> bool:
    """Return whether a folder looks like the bundle of a world with several infants."""
    folder = Path(path).expanduser()
    return (folder / INFANTS).is_dir() and (folder / MANIFEST).is_file()


@takes("the folder of a world's bundle", *PATH)
def read_world_bundle(path: str | Path) -> WorldBundle:
    """Read the world in a folder; files that are not listed in its lock are ignored.

    Raises:
        BundleError: If the folder is not the bundle of a world, or files are missing or changed.

    Example:
        >>> import mimoc
        >>> kim = mimoc.load_spec("nine_months.yaml")
        >>> folder = mimoc.write_bundle(mimoc.build_world({"kim": kim, "lee": kim}), "out/twins")
        >>> mimoc.read_world_bundle(folder)
        WorldBundle('world', kim, lee)
    """
    return read_locked(path, _parsed)


def load_world_model(bundle: WorldBundle) -> mujoco.MjModel:
    """Return the compiled model of a world, or raise a BundleError or ModelError as `load_model` does."""
    if bundle.path is not None:
        check_mjcf(bundle.path, bundle.files, (SCENE,), infants=len(bundle.infants))
    model = read_model(bundle.files, bundle.manifest.scene)
    if bundle.path is not None:
        for manifest in (bundle.manifest, *(infant.manifest for infant in bundle.infants.values())):
            check_fits(bundle.path, manifest, bundle.manifest.timestep_ms, model)
    prepare(model)
    return model


def take_pose(root_body: str, keyframe: str, data: mujoco.MjData) -> None:
    """Let an infant in a state have the pose of a keyframe, at its place there."""
    model, key = data.model, data.model.key(keyframe)
    is_part = in_subtrees(model, [model.body(root_body).id])
    for joint in np.flatnonzero(is_part[model.jnt_bodyid]):
        is_free = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE
        addresses = model.jnt_qposadr[joint] + np.arange(7 if is_free else 1)
        data.qpos[addresses] = key.qpos[addresses]
    actuators = np.flatnonzero(is_part[model.jnt_bodyid[model.actuator_trnid[:, 0]]])
    active = model.actuator_actadr[actuators][model.actuator_actadr[actuators] >= 0]
    data.act[active] = key.act[active]
    data.ctrl[actuators] = model.key_ctrl[key.id][actuators]


def overlaps(model: mujoco.MjModel, data: mujoco.MjData, roots: Sequence[str]) -> dict[tuple[int, int], float]:
    """Return how deep infants are within each other in a state, by their places among root bodies, [m]."""
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    root_of_geom = model.body_rootid[model.geom_bodyid]
    ids = [model.body(root).id for root in roots]
    depths: dict[tuple[int, int], float] = {}
    for pair, distance_m in zip(root_of_geom[data.contact.geom].tolist(), data.contact.dist.tolist(), strict=True):
        if pair[0] != pair[1] and -distance_m > TOUCH_M and set(pair) <= set(ids):
            first, second = sorted(map(ids.index, pair))
            depths[first, second] = max(depths.get((first, second), 0.0), -distance_m)
    return depths


def manifest_with_prefix(manifest: Manifest, prefix: str) -> Manifest:
    """Return what the runtime knows of an infant whose names begin with a prefix in the model."""
    keypoints = tuple(prefix + name for name in manifest.keypoints)
    return prefixed(manifest, prefix).model_copy(update={"prefix": prefix, "keypoints": keypoints})


def _parsed(files: Mapping[str, bytes], folder: Path) -> WorldBundle:
    try:
        manifest = WorldManifest.model_validate_json(files[MANIFEST])
    except ValidationError as error:
        raise BundleError(f"{MANIFEST}: this is no world: {problems_in(error)}; build it again") from None
    if missing := [name for name in manifest.infants if file_of(name, MANIFEST) not in files]:
        raise BundleError(f"{file_of(missing[0], MANIFEST)} is missing; build it again")
    manifests = {name: read_manifest(files[file_of(name, MANIFEST)]) for name in manifest.infants}
    for name, of_infant in manifests.items():
        if (of_infant.timestep_ms, of_infant.step_ms) != (manifest.timestep_ms, manifest.step_ms):
            raise BundleError(f"{file_of(name, MANIFEST)}: its steps are not those of the world; build it again")
    return world_bundle(files, manifest, manifests, folder)
