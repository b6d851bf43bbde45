"""Compilation of a spec to a bundle in memory, which MuJoCo checks."""

from collections.abc import Callable
from pathlib import Path

from mimoc.base.classes import PATH, takes
from mimoc.bundle.io import Bundle, read_bundle
from mimoc.compiler.building import builder
from mimoc.compiler.loading import SPEC_SUFFIXES, load_spec
from mimoc.schema.infant import InfantSpec


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
    return (compiler.watched(progress) if progress else compiler)(compiler.spec.scene.seed)


def compiled(source: Bundle | InfantSpec | str | Path) -> Bundle:
    """Return a bundle: the given one, the one in a folder, or that of a compiled spec or spec file (.yaml, .yml).

    Raises:
        BundleError: If a folder is not a complete bundle.
        SpecError: As `build`.
        ModelError: If MuJoCo rejects the model.
    """
    if isinstance(source, Bundle):
        return source
    if isinstance(source, InfantSpec) or Path(source).suffix.lower() in SPEC_SUFFIXES:
        return build(source)
    return read_bundle(source)
