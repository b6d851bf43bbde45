"""The infants that commands take: a bundle, a spec, or a spec from a pipe."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mimoc.errors import BundleError

if TYPE_CHECKING:
    from mimoc.bundle.folder import Bundle
    from mimoc.schema.infant import InfantSpec

PIPE = Path("-")


def take_spec(path: Path) -> "InfantSpec":
    """Return the spec that a file holds, or for `-` the standard input; relative paths in that are seen from here.

    Raises:
        SpecError: If anything is wrong with it.
    """
    from mimoc import schema
    from mimoc.compiler import loading
    from mimoc.schema import source

    if path != PIPE:
        return loading.load_spec(path)
    if sys.stdin.isatty():
        print("reading a spec from the terminal; Ctrl-D ends it", file=sys.stderr)
    return schema.read_spec(source.read_stream(sys.stdin.buffer, "<stdin>"))


def take_bundle(path: Path) -> "Bundle":
    """Return the bundle in a folder, or what a spec, from a file or for `-` from the standard input, compiles to.

    Raises:
        BundleError: If it is no whole bundle.
        SpecError: If a spec cannot be built.
        ModelError: If MuJoCo refuses the model.
    """
    from mimoc.bundle import folder
    from mimoc.cli import console
    from mimoc.compiler import loading, pipeline

    if path.is_file() and path.suffix.lower() not in loading.SPEC_SUFFIXES:
        raise BundleError(f"{path}: this is a file; name the folder of a bundle, or a spec that ends in .yaml or .yml")
    if path.is_dir() or (path != PIPE and path.suffix.lower() not in loading.SPEC_SUFFIXES):
        return folder.read_bundle(path)
    spec = take_spec(path)
    with console.status("building"):
        return pipeline.build(spec)


def take_bundles_spec(path: Path) -> "InfantSpec":
    """Return the spec that a file, the standard input or a bundle holds.

    Raises:
        BundleError: If it is no whole bundle.
        SpecError: If anything is wrong with the spec.
    """
    from mimoc.bundle import folder

    return resolved_spec(folder.read_bundle(path)) if path.is_dir() else take_spec(path)


def resolved_spec(built: "Bundle") -> "InfantSpec":
    """Return the whole spec of a bundle."""
    from mimoc import schema
    from mimoc.schema import source

    return schema.read_spec(source.parse(built.files["resolved.yaml"].decode(), "resolved.yaml"))
