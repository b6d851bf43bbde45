"""The toys of a folder of meshes, to choose from."""

from functools import cache, partial
from pathlib import Path

from mimoc.errors import UnknownToysError
from mimoc.toys.choosing import Toybox
from mimoc.toys.spec import ToysSpec
from mimoc.toys.toys4k.cache import MeshCache
from mimoc.toys.toys4k.convex import has_coacd
from mimoc.toys.toys4k.dataset import choose, expand_root, find_toys, unknown
from mimoc.toys.toys4k.meshes import load_toy

HULLS_ONLY = "toys touch with their convex hulls only; for a closer fit: pip install 'mimoc[toys]', and build again"


def build(spec: ToysSpec, folder: Path) -> Toybox:
    """Return the toys that a spec wants of its `root`, which is relative to *folder*.

    Raises:
        ToyError: If there are no toys.
        UnknownToysError: If there are none of some names.
    """
    found = find_toys(expand_root(str(spec.root), folder))
    if wrong := unknown(found, spec.subset):
        raise UnknownToysError(wrong)
    notes = () if has_coacd() else (HULLS_ONLY,)
    return Toybox(choose(found, spec.subset), cache(partial(load_toy, found, cache=MeshCache())), notes)
