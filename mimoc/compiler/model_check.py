"""Compiling a bundle's files with MuJoCo, and tracing its errors back to lines of the spec."""

import re
from collections.abc import Mapping
from typing import Any

import mujoco

from mimoc.base.errors import ModelError
from mimoc.bundle.model import mjcf_of
from mimoc.schema.source import Source


def compile_model(files: Mapping[str, bytes]) -> mujoco.MjModel:
    """Return the compiled scene of a bundle's files; raise a ModelError if MuJoCo rejects it."""
    try:
        return mujoco.MjModel.from_xml_string(*mjcf_of(files, "scene.xml"))
    except ValueError as error:
        message = _refusal(files) or " ".join(str(error).split())
        raise ModelError(f"MuJoCo rejects the model: {message}", _element(message, files)) from None


def trace_model_error(error: ModelError, written: Source, provenance: Mapping[str, Mapping[str, Any]]) -> ModelError:
    """Return the error of `compile_model` with the places in the spec that determine the element it is about."""
    if error.element is None:
        return ModelError(f"{written.file}: {error}; please report this")
    keys = sorted(tuple(key.split(".")[1:]) for key in _sources(error.element, provenance) if key.startswith("spec."))
    problems = [written.problem(key, f"'{error.element}' follows from this, and {error}") for key in keys]
    return ModelError("\n".join(map(str, problems)) or f"{written.file}: '{error.element}': {error}", error.element)


def _sources(element: str, provenance: Mapping[str, Mapping[str, Any]]) -> set[str]:
    """Return the keys of an element's numbers and of all numbers that these depend on."""
    pending = [key for key, entry in provenance.items() if f"[@name='{element}']" in entry.get("xml", "")]
    sources: set[str] = set()
    while pending:
        key = pending.pop()
        if key not in sources:
            sources.add(key)
            pending += provenance[key].get("from", ())
    return sources


def _refusal(files: Mapping[str, bytes]) -> str | None:
    try:
        mujoco.MjModel.from_xml_string(*mjcf_of(files, "infant.xml"))
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
