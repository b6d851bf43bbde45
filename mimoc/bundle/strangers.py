"""Whether a bundle that anyone may have written is one that mimoc could have written.

A lock says that nothing has changed since it was written, but not who wrote it. So the MJCF may consist of nothing but
what mimoc writes and refer to nothing but the bundle's own files, all of a bounded size, before MuJoCo reads any of it;
and what the manifest says must fit the model.
"""

import mujoco

from mimoc.bundle.asset_check import check_assets
from mimoc.bundle.io import Bundle
from mimoc.bundle.mjcf_check import read_mjcf
from mimoc.bundle.model_names import check_names
from mimoc.errors import BundleError
from mimoc.units import ms_to_s

INFANT, SCENE = "infant.xml", "scene.xml"
"""The MJCF of a bundle; the second includes the first, or is complete by itself."""


def check_files(bundle: Bundle) -> None:
    """Check the files that MuJoCo reads of a bundle, unless it was built here.

    Raises:
        BundleError: If mimoc does not write such files, or not of this size.
    """
    if bundle.path is None:
        return
    missing = [name for name in (INFANT, SCENE) if name not in bundle.files]
    if missing:
        raise BundleError(f"{bundle.path}: {' and '.join(missing)} are missing; build it again")
    try:
        infant, scene = (read_mjcf(name, bundle.files[name]) for name in (INFANT, SCENE))
        if infant.counts["include"]:
            raise BundleError(f"only {SCENE} may include {INFANT}")
        check_assets(bundle.files, {**infant.references, **scene.references})
    except BundleError as error:
        raise BundleError(f"{bundle.path}: {error}; do not use it") from None


def check_model(bundle: Bundle, model: mujoco.MjModel) -> None:
    """Check that the manifest of a bundle fits its model, unless it was built here.

    Raises:
        BundleError: If it does not.
    """
    if bundle.path is None:
        return
    try:
        if not abs(model.opt.timestep - ms_to_s(bundle.manifest.timestep_ms)) < 1e-9:
            raise BundleError(f"timestep_ms: the physics step of the model is {1000 * model.opt.timestep:g} ms")
        check_names(bundle.manifest, model)
    except BundleError as error:
        raise BundleError(f"{bundle.path}: {error}; build it again") from None
