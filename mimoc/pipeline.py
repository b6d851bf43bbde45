"""From a spec to a bundle in memory, checked by MuJoCo."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import mujoco

from mimoc import body, bundle, fits, render, scene, source
from mimoc.availability import refuse_unavailable
from mimoc.body.provenance import trace_body
from mimoc.errors import ModelError
from mimoc.fits.tables import data_files
from mimoc.fits.who import percentile
from mimoc.scene.manifest import describe
from mimoc.schema import InfantSpec, read_spec, to_data
from mimoc.schema.manifest import ChildEntry, Manifest
from mimoc.version import __version__

SPEC_FILE = "spec.yaml"


def load_spec(path: str | Path) -> InfantSpec:
    """Return the spec that a YAML file holds.

    Raises:
        SpecError: If anything is wrong with it, with all that is.
    """
    return read_spec(source.read(path))


def build(spec: InfantSpec) -> bundle.Bundle:
    """Compile a spec: a pure function, the same spec gives the same bytes.

    Raises:
        SpecError: If the spec asks for what this version cannot build.
        GeometryError: If no body has its measurements.
        ModelError: If MuJoCo refuses the model.
    """
    refuse_unavailable(spec)
    measurements = fits.measure(spec.age_months)
    tree = body.grow(measurements)
    world = scene.compose(spec, tree)
    manifest = Manifest.model_validate(render.rounded(describe(spec, tree, world).model_dump()))
    written = spec.source.text if spec.source else source.dump(to_data(spec))
    files = {
        **render.render_scene(world),
        SPEC_FILE: written.encode(),
        "resolved.yaml": source.dump(render.rounded(to_data(spec))).encode(),
        "provenance.json": render.render_json({**_trace_spec(spec), **trace_body(measurements, tree)}),
        "manifest.json": render.render_json(manifest.model_dump()),
        "README.md": render.render_text("README.md.j2", manifest=manifest, version=__version__),
    }
    compile_model(files)
    return bundle.seal(files, versions={"mimoc": __version__}, inputs=data_files())


def who_percentiles(child: ChildEntry) -> dict[str, float]:
    """Return where a child stands among WHO's boys and girls of its age, 0 to 100, by indicator.

    An indicator that WHO has no standard for at that age is left out.
    """
    measures = child.model_dump()
    return {
        indicator: percentile(standard.z_score(measures[indicator], child.age_months, "mean"))
        for indicator, standard in fits.load_tables().who.items()
        if standard.covers(child.age_months)
    }


def compile_model(files: Mapping[str, bytes]) -> mujoco.MjModel:
    """Return the compiled scene of a bundle's files.

    Raises:
        ModelError: If MuJoCo refuses it; the message names the element and where in the XML it stands.
    """
    try:
        return mujoco.MjModel.from_xml_string(files["scene.xml"].decode(), assets=dict(files))
    except ValueError as error:
        raise ModelError(_explain_refusal(str(error), files)) from None


def _explain_refusal(message: str, files: Mapping[str, bytes]) -> str:
    """Return MuJoCo's message with the name of the element it means and the numbers behind it."""
    text = " ".join(message.split())
    names = (name for name in re.findall(r"'([^']+)'", text) if name.encode() in files["infant.xml"])
    name = next(names, None) or _name_on_line(text, files["infant.xml"].decode())
    advice = f"see what its numbers come from with 'mimo explain', keys ending in '{name}'" if name else "report this"
    return f"infant.xml: MuJoCo refuses the model: {text}; {advice}"


def _name_on_line(message: str, xml: str) -> str | None:
    """Return the name of the element on the line that a message speaks of."""
    line = re.search(r"line (\d+)", message)
    lines = xml.splitlines()
    if not line or int(line[1]) > len(lines):
        return None
    name = re.search(r'name="([^"]+)"', lines[int(line[1]) - 1])
    return name and name[1]


def _trace_spec(spec: InfantSpec) -> dict[str, dict[str, Any]]:
    """Return where each value of the spec was written, by key; `spec.age_months`."""
    return {
        ".".join(("spec", *map(str, path))): {"value": value, "rule": _written(spec, path)}
        for path, value in _leaves(to_data(spec))
    }


def _written(spec: InfantSpec, path: tuple[str | int, ...]) -> str:
    if spec.source is None or path not in spec.source.value_places:
        return "default"
    line, column = spec.source.locate(path)
    return f"{SPEC_FILE}:{line}:{column}"


def _leaves(data: Mapping[str, Any], above: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    """Return the path and value of everything in nested data that is not a section."""
    found = []
    for key, value in data.items():
        path = (*above, key)
        found += _leaves(value, path) if isinstance(value, Mapping) else [(path, value)]
    return found
