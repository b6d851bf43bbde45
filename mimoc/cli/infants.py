"""Loading the infant that a command is given: a bundle, a spec, or a spec from standard input."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mimoc.errors import BundleError

if TYPE_CHECKING:
    from mimoc.bundle.io import Bundle
    from mimoc.schema.infant import InfantSpec

STDIN = Path("-")


def load_spec(path: Path) -> "InfantSpec":
    """Return the spec in a file or, for `-`, in standard input, where paths are relative to the working directory.

    Raises:
        SpecError: If the spec is invalid.
    """
    from mimoc import schema
    from mimoc.compiler import loading
    from mimoc.schema import source

    if path != STDIN:
        return loading.load_spec(path)
    if sys.stdin.isatty():
        print("reading a spec from the terminal; end it with Ctrl-D", file=sys.stderr)
    return schema.read_spec(source.read_stream(sys.stdin.buffer, "<stdin>"))


def load_infant(path: Path) -> "Bundle":
    """Return the bundle in a folder, or the bundle built from a spec in a file or, for `-`, in standard input.

    Raises:
        BundleError: If the folder is not an intact bundle.
        SpecError: If the spec cannot be built.
        ModelError: If MuJoCo rejects the model.
    """
    from mimoc.bundle.io import read_bundle
    from mimoc.cli import console
    from mimoc.compiler import loading, pipeline

    if path.is_file() and path.suffix.lower() not in loading.SPEC_SUFFIXES:
        raise BundleError(f"{path}: this is a file; name the folder of a bundle, or a spec that ends in .yaml or .yml")
    if path.is_dir() or (path != STDIN and path.suffix.lower() not in loading.SPEC_SUFFIXES):
        return read_bundle(path)
    spec = load_spec(path)
    with console.progress("building") as show:
        return pipeline.build(spec, progress=show)


def load_spec_of_infant(path: Path) -> "InfantSpec":
    """Return the spec in a file, in standard input or in a bundle.

    Raises:
        BundleError: If the folder is not an intact bundle.
        SpecError: If the spec is invalid.
    """
    from mimoc.bundle.io import read_bundle

    return resolved_spec(read_bundle(path)) if path.is_dir() else load_spec(path)


def resolved_spec(bundle: "Bundle") -> "InfantSpec":
    """Return the spec of a bundle with all defaults filled in.

    Raises:
        BundleError: If the bundle does not contain it.
        SpecError: If this version of mimoc does not read it.
    """
    from mimoc.compiler.variants import spec_of

    return spec_of(bundle)
