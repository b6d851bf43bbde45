"""Builds the set of toys from a folder of meshes."""

from functools import cache, partial
from pathlib import Path

from mimoc.errors import UnknownToysError
from mimoc.toys.choosing import Toybox
from mimoc.toys.spec import ToysSpec
from mimoc.toys.toys4k.cache import MeshCache
from mimoc.toys.toys4k.convex import has_coacd
from mimoc.toys.toys4k.dataset import choose, expand_root, find_toys, unknown
from mimoc.toys.toys4k.meshes import load_toy

HULLS_ONLY = "each toy collides as its convex hull; for a closer fit, run: pip install 'mimoc[toys]', and build again"


def build(spec: ToysSpec, folder: Path) -> Toybox:
    """Return the toys that a spec selects from its `root`, which is relative to *folder*.

    Raises:
        ToyError: If there are no toys.
        UnknownToysError: If some of the selected names do not exist.
    """
    toys = find_toys(expand_root(str(spec.root), folder))
    if wrong := unknown(toys, spec.subset):
        raise UnknownToysError(wrong)
    notes = () if has_coacd() else (HULLS_ONLY,)
    return Toybox(choose(toys, spec.subset), cache(partial(load_toy, toys, cache=MeshCache())), notes)
