"""From a spec to a bundle in memory, checked by MuJoCo."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc import body, fits
from mimoc.actuation.drives import build_drive
from mimoc.body.provenance import trace_body
from mimoc.bundle.arrays import ARRAYS, pack_arrays
from mimoc.bundle.io import Bundle, read_bundle, seal
from mimoc.bundle.json_text import render_json
from mimoc.bundle.manifest import ChildEntry, Manifest, ToyEntry
from mimoc.compiler.availability import refuse_unavailable
from mimoc.compiler.compose import compose, place_senses
from mimoc.compiler.describe import describe, describe_toys
from mimoc.compiler.diagnosis import blame
from mimoc.compiler.furnish import Supplies, furnish, outline, set_up_task
from mimoc.compiler.provenance.actuation import trace_drive
from mimoc.compiler.provenance.child import trace_child
from mimoc.compiler.provenance.delays import trace_delays
from mimoc.compiler.provenance.task import trace_task
from mimoc.compiler.provenance.world import trace_world
from mimoc.compiler.scene_assets import gather, notes
from mimoc.errors import (
    GeometryError,
    IndividualError,
    ModelError,
    NoRoomError,
    SpecError,
    ToyError,
    UnplayableError,
)
from mimoc.fits.tables import data_files
from mimoc.fits.who import percentile
from mimoc.mjcf import printing
from mimoc.mjcf.conventions import find_convention
from mimoc.mjcf.placed import Placed
from mimoc.mjcf.tree import SceneTree
from mimoc.rounding import rounded, rounded_array
from mimoc.schema import source
from mimoc.schema.infant import InfantSpec, as_written, read_spec, to_data, validated
from mimoc.schema.yaml_scalars import dump
from mimoc.tasks.setup import TaskSetup
from mimoc.units import ms_to_s
from mimoc.version import __version__

SPEC_FILE = "spec.yaml"
SPEC_SUFFIXES = (".yaml", ".yml")


def load_spec(path: str | Path) -> InfantSpec:
    """Return the spec that a YAML file holds.

    Raises:
        SpecError: If anything is wrong with it, with all that is.
    """
    return read_spec(source.read(path))


def build(spec: InfantSpec | str | Path, convention: str | None = None) -> Bundle:
    """Compile a spec: a pure function, the same spec (and the same files that it names) gives the same bytes.

    Args:
        spec: The spec, or the path of its YAML file.
        convention: Other people's code to build it for, by a name of `scene.conventions`.

    Raises:
        UnknownNameError: If there is no such convention.
        SpecError: If the spec is wrong or has not passed validation, or if it asks for what this version cannot build,
            for a child that there is none of, or for toys or pictures that are not there.
        ModelError: If MuJoCo refuses the model.
    """
    compiler = builder(spec if isinstance(spec, InfantSpec) else load_spec(spec), convention)
    return compiler(compiler.spec.scene.seed)


def compiled(source: Bundle | InfantSpec | str | Path) -> Bundle:
    """Return a bundle as it is, the bundle in a folder, or what a spec or the file of one (.yaml, .yml) compiles to.

    Raises:
        BundleError: If a folder is not a whole bundle.
        SpecError: As `build`.
        ModelError: If MuJoCo refuses the model.
    """
    if isinstance(source, Bundle):
        return source
    if isinstance(source, InfantSpec) or Path(source).suffix.lower() in SPEC_SUFFIXES:
        return build(source)
    return read_bundle(source)


@dataclass(frozen=True, slots=True, repr=False)
class Builder:
    """A spec whose child is grown: what is left to do is to put it into the world that a seed draws."""

    spec: InfantSpec
    convention: str | None
    """The code it is built for, if not mimoc's alone."""
    tree: body.BodyTree
    infant: SceneTree
    """In no world yet."""
    stage: TaskSetup
    """What its task needs."""
    discs: npt.NDArray[np.float64]
    """What it takes up of the floor."""
    supplies: Supplies
    files: Mapping[str, bytes]
    """Of the infant alone."""
    manifest: Manifest
    origins: Mapping[str, Any]
    """Where the infant's numbers come from."""

    def __repr__(self) -> str:
        """Return whom it builds, in a line."""
        return f"Builder({self.spec.name!r}, {self.spec.age_months:g} months)"

    def __reduce__(self) -> tuple[Any, ...]:
        """Let it be copied and sent to other processes, which grow the child anew."""
        return builder, (self.spec, self.convention)

    def __call__(self, seed: int, *, check: bool = True) -> Bundle:
        """Return the bundle of a seed.

        Args:
            seed: Of the scene.
            check: Whether to have MuJoCo check the model; what loads it next does so too.

        Raises:
            SpecError: If there is no room for the toys, or nothing can be made of one.
            ModelError: If MuJoCo refuses the model.
        """
        spec = _with_seed(self.spec, seed)
        written = as_written(spec)
        try:
            furnished = find_convention(self.convention).world(
                furnish(self.infant, spec, self.tree, self.supplies, self.stage, self.discs)
            )
        except (NoRoomError, ToyError) as error:
            raise SpecError(written.problem(("scene", "toys"), line) for line in str(error).splitlines()) from None
        toys = tuple(ToyEntry.model_validate(rounded(toy.model_dump())) for toy in describe_toys(furnished))
        changes = {"seed": seed, "toys": toys, "notes": notes(spec, self.supplies.toybox, self.convention)}
        manifest = self.manifest.model_copy(update=changes)
        own_origins = {**_trace_spec(spec, written), **trace_world(spec, furnished)}
        files = {
            **self.files,
            **printing.render_world(furnished),
            SPEC_FILE: written.text.encode(),
            "resolved.yaml": dump(rounded(to_data(spec))).encode(),
            "provenance.json": render_json({**own_origins, **self.origins}),
            "manifest.json": render_json(manifest.model_dump()),
            "README.md": printing.render_text("README.md.j2", manifest=manifest, version=__version__),
        }
        try:
            if check:
                compile_model(files)
        except ModelError as error:
            raise _blame(error, written, {**own_origins, **self.origins}) from None
        return seal(files, {"mimoc": __version__}, data_files(), manifest)


def builder(spec: InfantSpec, convention: str | None = None) -> Builder:
    """Return what compiles a spec for any seed of its scene; the child, which is always the same, is grown now.

    Raises:
        UnknownNameError: If there is no such convention.
        SpecError: As `build`.
    """
    wanted = find_convention(convention)
    spec = validated(spec)
    refuse_unavailable(spec)
    written = as_written(spec)
    anatomy = body.assemble(spec.body.hands, spec.body.chest_joint)
    try:
        measurements = body.measure_child(spec, anatomy)
        tree = wanted.body(body.grow_child(spec, measurements, anatomy))
    except (GeometryError, IndividualError) as error:
        raise SpecError([blame(error, spec, written)]) from None
    try:
        drive = build_drive(spec.actuation, tree, ms_to_s(spec.control.timestep_ms))
        senses = place_senses(spec, tree)
        staged, stage = set_up_task(compose(spec, tree, drive, senses), spec, tree, drive)
        infant = wanted.infant(staged, spec.actuation.model)
        described = describe(spec, tree, infant, senses, stage)
    except UnplayableError as error:
        raise SpecError([written.problem(error.key, str(error))]) from None
    manifest = Manifest.model_validate(rounded(described.model_dump()))
    scaled: dict[str, tuple[str, ...]] = {}
    for name, part in spec.body.parts.items():
        keys = (f"spec.body.parts.{name}.{key}" for key, _ in part)
        scaled[tree.home(name)] = (*scaled.get(tree.home(name), ()), *keys)
    origins = {
        **trace_body(measurements, anatomy, tree, scaled),
        **trace_drive(spec.actuation.model, anatomy, tree, replace(drive, actuators=infant.actuators)),
        **dict(trace_delays(spec, manifest.delays)),
        **{key: entry for placed in senses.values() for key, entry in placed.origins.items()},
        **trace_task(manifest.task),
        **trace_child(tree, manifest.child, who_percentiles(manifest.child)),
    }
    return Builder(
        spec=spec,
        convention=convention,
        tree=tree,
        infant=infant,
        stage=stage,
        discs=outline(infant, spec.scene, tree),
        supplies=gather(spec, written),
        files={**printing.render_infant(infant), **_arrays(senses)},
        manifest=manifest,
        origins=origins,
    )


def _arrays(senses: Mapping[str, Placed]) -> dict[str, bytes]:
    """Return the file that holds the large arrays of all senses, if there are any."""
    arrays = {
        f"{sense}/{name}": rounded_array(array)
        for sense, placed in senses.items()
        for name, array in placed.arrays.items()
    }
    return {ARRAYS: pack_arrays(arrays)} if arrays else {}


def _with_seed(spec: InfantSpec, seed: int) -> InfantSpec:
    """Return a spec whose scene has another seed."""
    return spec if seed == spec.scene.seed else spec.with_(scene={"seed": seed})


def who_percentiles(child: ChildEntry) -> dict[str, float]:
    """Return where a child stands among WHO's children of its age and sex, 0 to 100, by indicator.

    An indicator that WHO has no standard for at that age is left out.
    """
    measures = child.model_dump()
    return {
        indicator: percentile(standard.z_score(measures[indicator], child.age_months, child.sex or "mean"))
        for indicator, standard in fits.load_tables().who.items()
        if standard.covers(child.age_months) and measures[indicator] is not None
    }


def compile_model(files: Mapping[str, bytes]) -> mujoco.MjModel:
    """Return the compiled scene of a bundle's files.

    Raises:
        ModelError: If MuJoCo refuses it.
    """
    try:
        return mujoco.MjModel.from_xml_string(files["scene.xml"].decode(), assets=dict(files))
    except ValueError as error:
        message = _refusal(files) or " ".join(str(error).split())
        raise ModelError(f"MuJoCo refuses the model: {message}", _element(message, files)) from None


def _refusal(files: Mapping[str, bytes]) -> str | None:
    """Return what MuJoCo says of the infant alone: its line counts are those of that file, not of what includes it."""
    try:
        mujoco.MjModel.from_xml_string(files["infant.xml"].decode(), assets=dict(files))
    except ValueError as error:
        return " ".join(str(error).split())
    return None


def _element(message: str, files: Mapping[str, bytes]) -> str | None:
    """Return the name of the element that MuJoCo's message is about: it gives the name, or the line in the XML."""
    xml = files["infant.xml"].decode()
    line = re.search(r"line (\d+)", message)
    on_line = re.search(r'name="([^"]+)"', "".join(xml.splitlines()[int(line[1]) - 1 : int(line[1])])) if line else None
    quoted = (name for name in re.findall(r"'([^']+)'", message) if f'name="{name}"' in xml)
    return next(quoted, on_line and on_line[1])


def _blame(error: ModelError, written: source.Source, provenance: Mapping[str, Mapping[str, Any]]) -> ModelError:
    """Return the error with the element it is about, and the places of the spec that made the element what it is."""
    if error.element is None:
        return ModelError(f"{written.file}: {error}; please report this")
    pending = [key for key, entry in provenance.items() if f"[@name='{error.element}']" in entry.get("xml", "")]
    seen: set[str] = set()
    while pending:
        key = pending.pop()
        if key not in seen:
            seen.add(key)
            pending += provenance[key].get("from", ())
    keys = sorted(tuple(key.split(".")[1:]) for key in seen if key.startswith("spec."))
    problems = [written.problem(key, f"'{error.element}' follows from this, and {error}") for key in keys]
    return ModelError("\n".join(map(str, problems)) or f"{written.file}: '{error.element}': {error}", error.element)


def _trace_spec(spec: InfantSpec, written: source.Source) -> dict[str, dict[str, Any]]:
    """Return where each value of the spec was written, by key; `spec.age_months`."""
    found = {}
    for path, value in _leaves(to_data(spec)):
        line, column = written.locate(path)
        rule = f"{SPEC_FILE}:{line}:{column}" if path in written.value_places else "default"
        found[".".join(("spec", *path))] = {"value": value, "rule": rule}
    return found


def _leaves(data: Mapping[str, Any], above: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    """Return the path and value of everything in nested data that is not a section."""
    found = []
    for key, value in data.items():
        path = (*above, key)
        found += _leaves(value, path) if isinstance(value, Mapping) else [(path, value)]
    return found
