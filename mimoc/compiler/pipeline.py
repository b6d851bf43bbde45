"""From a spec to a bundle in memory, checked by MuJoCo."""

from pathlib import Path

from mimoc.bundle.io import Bundle, read_bundle
from mimoc.compiler.building import builder
from mimoc.compiler.loading import SPEC_SUFFIXES, load_spec
from mimoc.schema.infant import InfantSpec


def build(spec: InfantSpec | str | Path, target: str | None = None) -> Bundle:
    """Compile a spec: a pure function, the same spec (and the same files that it names) gives the same bytes.

    Args:
        spec: The spec, or the path of its YAML file.
        target: Other software to build it for, by a name of `mjcf.compatibility.TARGETS`.

    Raises:
        UnknownNameError: If there is no such target.
        SpecError: If the spec is wrong or has not passed validation, if this version cannot build what it asks for, if
            no child matches the requested measures, or if toys or pictures are missing.
        ModelError: If MuJoCo refuses the model.
    """
    compiler = builder(spec if isinstance(spec, InfantSpec) else load_spec(spec), target)
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
