"""Compilation of a spec to a bundle in memory, which MuJoCo checks, for any seed of its scene."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.anatomy.parts import PARTS
from mimoc.base.arrays import rounded_array
from mimoc.base.classes import PATH, takes
from mimoc.base.errors import ModelError, SpecError, UnsupportedTaskError
from mimoc.base.rounding import render_json, rounded
from mimoc.base.units import ms_to_s
from mimoc.body.grow import GrownBody
from mimoc.body.provenance import trace_body
from mimoc.body.tree import BodyTree
from mimoc.bundle.io import ARRAYS, Array, Bundle, LazyArrays, lock_files, pack_arrays, read_bundle
from mimoc.bundle.manifest import Manifest, to_data as manifest_data
from mimoc.bundle.provenance import PROVENANCE, packed
from mimoc.bundle.variants import MOVING, array_of
from mimoc.compiler.actuation import ActuationSetup, build_actuation, trace_voice
from mimoc.compiler.assembling import assemble_infant, place_senses
from mimoc.compiler.child import check_available, child_of
from mimoc.compiler.manifest import (
    describe_objects,
    describe_toys,
    make_manifest,
    notes,
    notes_on_shapes,
    rounded_caregiver,
)
from mimoc.compiler.mjcf import printing
from mimoc.compiler.mjcf.mimo import find_target
from mimoc.compiler.mjcf.scene import Placed, SceneTree, Skin
from mimoc.compiler.model_check import compile_model, trace_model_error
from mimoc.compiler.placing import (
    PlacedScene,
    SceneAssets,
    check_offers,
    covered_floor,
    errors_in_file,
    load_scene_assets,
    place_in_scene,
    set_up_task,
)
from mimoc.compiler.presets import trace_delays, trace_noise
from mimoc.compiler.provenance import (
    SPEC_FILE,
    trace_actuation,
    trace_birth,
    trace_child,
    trace_clothes,
    trace_plugins,
    trace_spec,
    trace_task,
    trace_world,
)
from mimoc.compiler.scenes import footprint
from mimoc.compiler.task_setup import TaskSetup
from mimoc.fits import load_tables
from mimoc.schema.infant import SPEC_SUFFIXES, InfantSpec, as_written, load_spec, to_data, validated
from mimoc.schema.source import dump
from mimoc.version import __version__


@dataclass(frozen=True, repr=False)
class Builder:
    """A spec whose infant has been built, and whose scene is built for each seed."""

    spec: InfantSpec
    target: str | None  # Name of the other software that it is built for, if any.
    grown: GrownBody  # The infant's body as it grew.
    tree: BodyTree  # That body, as the target has it.
    actuation: ActuationSetup
    senses: Mapping[str, Placed]
    infant: SceneTree
    """The infant with senses and actuators, with its poses at the origin, before it is placed in a world."""
    task_setup: TaskSetup
    infant_discs: npt.NDArray[np.float64]
    """Discs by x, y and radius that the infant covers in all its poses, shape (n, 3), [m]; empty if neither toys nor
    the scene need them."""
    scene_assets: SceneAssets  # The toys and wallpapers that scenes choose from.
    manifest: Manifest  # The manifest, without the fields that depend on the seed.
    has_skin: bool

    @cached_property
    def infant_and_task_discs(self) -> npt.NDArray[np.float64]:
        """Discs that the infant at the origin, in all its poses, and its task cover, always computed; shape (n, 3)."""
        discs = footprint(self.tree, [pose.qpos for pose in self.infant.keyframes])
        return np.concatenate([discs, np.reshape(self.task_setup.taken, (-1, 3))])

    @cached_property
    def files(self) -> Mapping[str, bytes]:
        """The infant's files, by path in the bundle."""
        return {**self._mjcf, **({ARRAYS: pack_arrays(self.arrays)} if self.arrays else {})}

    @cached_property
    def _mjcf(self) -> Mapping[str, bytes]:
        return printing.render_infant(self.infant)

    @cached_property
    def _inhabitant(self) -> bytes:
        return printing.render_inhabitant(self.infant) if self.infant.skin else self._mjcf[printing.INFANT]

    def mjcf_of(self, furnished: PlacedScene) -> Mapping[str, bytes]:
        """Return the MJCF and assets of a scene: the part of its bundle that MuJoCo reads."""
        return {**self._mjcf, **printing.render_world(furnished.scene, self._inhabitant)}

    @cached_property
    def arrays(self) -> Mapping[str, npt.NDArray[Any]]:
        """The large arrays of all senses and of the face by name, as they are in the file, read-only."""
        arrays = {}
        for sense, placed in self.senses.items():
            for name, array in placed.arrays.items():
                arrays[f"{sense}/{name}"] = rounded_array(array).view()
                arrays[f"{sense}/{name}"].flags.writeable = False
        shapes = self.manifest.face.shapes if self.manifest.face else ()
        names = [MOVING, *map(array_of, shapes)] if shapes else []
        return LazyArrays(arrays, names, lambda: face_arrays(self.infant.skin))

    @cached_property
    def origins(self) -> Mapping[str, Any]:
        """Provenance of the infant's numbers, by key in `provenance.json`."""
        spec = self.spec
        tree = self.tree
        manifest = self.manifest
        # Each part's keys in the spec that scale it, by the name that the part has in the body.
        scaled: dict[str, tuple[str, ...]] = {}
        for name, part in spec.body.parts.items():
            keys = (f"spec.body.parts.{name}.{key}" for key, _ in part)
            scaled[tree.home(name)] = (*scaled.get(tree.home(name), ()), *keys)
        of_body = trace_body(self.grown, tree, scaled)
        written = replace(self.actuation, actuators=self.infant.actuators, defaults=self.infant.actuator_defaults)
        entries = {
            **trace_actuation(spec.actuation.model, tree, written, of_body),
            **dict(trace_delays(spec, manifest.delays)),
            **dict(trace_noise(spec, manifest.noise)),
            **dict(trace_voice(manifest.actuation.voice)),
            **{key: entry for placed in self.senses.values() for key, entry in placed.origins.items()},
            **trace_task(manifest.task),
            **trace_plugins(manifest.plugins),
            **dict(trace_child(tree, manifest.child)),
            **dict(trace_birth(spec)),
            **dict(trace_clothes(spec)),
        }
        return find_target(self.target).origins(tree, entries)

    def __repr__(self) -> str:
        return f"Builder({self.spec.name!r}, {self.spec.age_months:g} months)"

    def __reduce__(self) -> tuple[Any, ...]:
        return builder, (self.spec, self.target, None, self.has_skin)

    def with_progress(self, progress: Callable[[int, int], None]) -> "Builder":
        """Return a copy that calls a function with the number of toys loaded and their total."""
        assets = self.scene_assets
        return replace(self, scene_assets=replace(assets, toybox=replace(assets.toybox, progress=progress)))

    def __call__(self, seed: int, *, check: bool = True) -> Bundle:
        """Return the bundle of a seed.

        Args:
            seed: Seed of the scene.
            check: Whether to compile the model with MuJoCo to check it; loading the bundle does so as well.

        Raises:
            SpecError: If there is not enough space for the toys, or a mesh cannot be used.
            ModelError: If MuJoCo rejects the model.
        """
        return self.to_bundle(seed, self.place_scene(seed), check=check)

    def to_bundle(self, seed: int, furnished: PlacedScene, *, check: bool = False) -> Bundle:
        """Return the bundle of a seed, whose scene is furnished already; see `__call__`."""
        spec = _with_seed(self.spec, seed)
        world_origins = {**trace_spec(spec, as_written(spec)), **trace_world(spec, furnished)}
        manifest = self.manifest_of(seed, furnished)
        files = {
            **self.files,
            **printing.render_world(furnished.scene, self._inhabitant),
            SPEC_FILE: as_written(spec).text.encode(),
            "resolved.yaml": dump(rounded(to_data(spec))).encode(),
            PROVENANCE: render_json(packed({**world_origins, **self.origins}), 2),
            "manifest.json": render_json(manifest_data(manifest)),
            "README.md": printing.render_text("README.md.j2", manifest=manifest, version=__version__),
        }
        try:
            if check:
                compile_model(files)
        except ModelError as error:
            raise trace_model_error(error, as_written(spec), {**world_origins, **self.origins}) from None
        return lock_files(files, {"mimoc": __version__}, load_tables().files, manifest)

    def place_scene(self, seed: int) -> PlacedScene:
        """Return the scene of a seed, before it is written; a SpecError says which toy or object has no place."""
        spec = _with_seed(self.spec, seed)
        with errors_in_file(lambda: as_written(spec)):
            furnished = place_in_scene(
                self.infant, spec, self.tree, self.scene_assets, self.task_setup, self.infant_discs
            )
        check_offers(spec.scene.caregiver, furnished.toys, furnished.things, lambda: as_written(spec))
        return replace(furnished, scene=find_target(self.target).world(furnished.scene))

    def manifest_of(self, seed: int, furnished: PlacedScene) -> Manifest:
        """Return the manifest of a seed."""
        remarks = notes(self.spec, self.scene_assets.toybox, self.manifest.plugins, self.target)
        remarks += notes_on_shapes(furnished.toys, furnished.things)
        of_scene = {"toys": describe_toys(furnished.toys), "objects": describe_objects(furnished.things)}
        of_scene["poses"] = tuple(pose.name for pose in furnished.scene.keyframes)
        of_scene["caregiver"] = rounded_caregiver(furnished.caregiver)
        return self.manifest.model_copy(update={"seed": seed, **of_scene, "notes": remarks})


def sees_skin(spec: InfantSpec) -> bool:
    """Return whether an infant's eyes see skins: one of many has a skin only then, if its spec does not say."""
    vision = spec.senses.vision
    if vision is None or vision.body == "solids":
        return False
    return vision.body == "skin" or spec.development != "published"


def builder(spec: InfantSpec, target: str | None = None, younger: Builder | None = None, skin: bool = True) -> Builder:
    """Return a builder of a spec; the infant, which does not depend on the seed, is built at once.

    Args:
        spec: The spec.
        target: Name of the other software that it is built for, if any.
        younger: A builder of the same valid spec at another age, from which this takes what does not depend on age.
        skin: Whether it has a skin, if its spec does not say.

    """
    compatibility = find_target(target)
    if younger is None:
        spec = validated(spec)
        if compatibility.chest_joint and "chest_joint" not in spec.body.model_fields_set:
            spec = spec.with_(body={"chest_joint": True})
        check_available(spec)
    grown = child_of(spec, younger and younger.grown.reference)
    if target is not None and grown.tree.reflexes:
        message = f"{target}'s code knows no stretch reflexes of spastic muscles; leave spastic tone out"
        raise SpecError([as_written(spec).problem(("impairments",), message)])
    tree = compatibility.body(grown.tree)
    has_skin = spec.body.skin
    if has_skin is None:
        has_skin = skin and target is None and PARTS.distribution(spec.body.hands) == "mimoc"
    try:
        actuation = build_actuation(spec.actuation, tree, ms_to_s(spec.control.timestep_ms))
        senses = place_senses(spec, tree)
        scene, task_setup = set_up_task(assemble_infant(spec, tree, actuation, senses, has_skin), spec, tree, actuation)
        infant = compatibility.infant(scene, spec.actuation.model)
        manifest = make_manifest(spec, tree, infant, senses, task_setup)
    except UnsupportedTaskError as error:
        raise SpecError([as_written(spec).problem(error.key, str(error))]) from None
    return Builder(
        spec=spec,
        target=target,
        grown=grown,
        tree=tree,
        actuation=actuation,
        senses=senses,
        infant=infant,
        task_setup=task_setup,
        infant_discs=covered_floor(infant, spec.scene, tree),
        scene_assets=younger.scene_assets if younger else load_scene_assets(spec),
        manifest=manifest,
        has_skin=has_skin,
    )


def _with_seed(spec: InfantSpec, seed: int) -> InfantSpec:
    return spec if seed == spec.scene.seed else spec.with_(scene={"seed": seed})


def face_arrays(skin: Skin | None) -> dict[str, Array]:
    """Return the arrays of a face by name: what any expression moves, and how far each moves it, in steps."""
    if skin is None or not skin.moves:
        return {}
    is_moved = np.any([steps.any(axis=1) for steps in skin.moves.values()], axis=0)
    arrays = {MOVING: np.flatnonzero(is_moved).astype(np.uint16)}
    arrays |= {array_of(name): steps[is_moved] for name, steps in skin.moves.items()}
    for array in arrays.values():
        array.flags.writeable = False
    return arrays


@takes("a spec, or the path of one", InfantSpec, *PATH)
def build(
    spec: InfantSpec | str | Path, target: str | None = None, *, progress: Callable[[int, int], None] | None = None
) -> Bundle:
    """Compile a spec: a pure function, the same spec (and the same files that it names) gives the same bytes.

    Args:
        spec: The spec, or the path of its YAML file.
        target: Other software to build it for, by a name of `mjcf.mimo.TARGETS`.
        progress: Called with the number of toys loaded and their total; the first time, meshes take long.

    Raises:
        UnknownNameError: If the target does not exist.
        SpecError: If the spec is invalid, if this version cannot build it, if no child matches the requested measures,
            or if toys or textures are missing.
        ModelError: If MuJoCo rejects the model.

    Example:
        >>> import mimoc
        >>> bundle = mimoc.build("nine_months.yaml")
        >>> bundle.manifest.child.age_months, round(bundle.manifest.child.length_cm)
        (9.0, 70)
        >>> mimoc.write_bundle(bundle, "out/built").name
        'built'
    """
    compiler = builder(spec if isinstance(spec, InfantSpec) else load_spec(spec), target)
    if progress:
        compiler = compiler.with_progress(progress)
    return compiler(compiler.spec.scene.seed)


def compiled(source: Bundle | InfantSpec | str | Path) -> Bundle:
    """Return a bundle: the given one, the one in a folder, or that of a compiled spec or spec file; see `build`."""
    if isinstance(source, Bundle):
        return source
    if isinstance(source, InfantSpec) or Path(source).suffix.lower() in SPEC_SUFFIXES:
        return build(source)
    return read_bundle(source)
