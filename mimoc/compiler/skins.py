"""The skin of an infant at any age, for whoever draws it otherwise than MuJoCo does."""

from pathlib import Path

from mimoc.bundle.io import Bundle
from mimoc.compiler.aged import aged, errors_at
from mimoc.compiler.child import child_of
from mimoc.compiler.loading import load_spec
from mimoc.compiler.variants import spec_of
from mimoc.looks.skin.carrying import skin_of
from mimoc.mjcf.skin import SkinLayer
from mimoc.schema.infant import InfantSpec


def skin_at(source: InfantSpec | Bundle | str | Path, age_months: float | None = None) -> tuple[SkinLayer, ...]:
    """Return the layers of the skin of an infant, whether it is built with one or not.

    Layers are the same at all ages but for the places of their vertices and bones: `verts_m`, `origins_m`, `turns`.
    A vertex is at the sum over bones of `weights[:, b] * (world_from_b @ turns[b].T @ (verts_m - origins_m[b]) +
    place of b in the world)`. The textures are those of the bundle, `assets/skin_*.png`.

    Args:
        source: A spec, the path of its file, or a bundle.
        age_months: Another age than its own.

    Raises:
        SpecError: If there is no such child.
        BundleError: If the bundle does not contain its spec.
    """
    if isinstance(source, Bundle):
        spec = spec_of(source)
    else:
        spec = source if isinstance(source, InfantSpec) else load_spec(source)
    age_months = spec.age_months if age_months is None else age_months
    with errors_at(spec, age_months):
        tree = child_of(aged(spec, age_months)).tree
    return skin_of(tree).layers
