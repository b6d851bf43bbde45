"""Peak joint torques of an infant."""

from pathlib import Path

from mimoc.base.classes import PATH, takes
from mimoc.bundle.io import Bundle, read_bundle
from mimoc.bundle.model import load_model
from mimoc.runtime.actuation import all_commanded, bind_actuation


@takes("a bundle, or the folder of one", Bundle, *PATH)
def torque_limits(bundle: Bundle | str | Path) -> dict[str, tuple[float, float]]:
    """Return the peak torques at each actuated hinge joint, in negative and positive direction, in [N m].

    The first is negative. For muscles it is the isometric torque at optimal length; for position actuators it is that
    of the torque motors.

    Args:
        bundle: A bundle, or a bundle folder.

    Raises:
        BundleError: If the folder is not an intact bundle.
        ModelError: If MuJoCo rejects its model.

    Example:
        >>> import mimoc
        >>> limits_nm = mimoc.torque_limits("out/nine_months")
        >>> least, most = limits_nm["robot:right_elbow"]
        >>> least < 0 < most
        True
    """
    bundle = bundle if isinstance(bundle, Bundle) else read_bundle(bundle)
    entry = all_commanded(bundle.manifest.actuation)
    actuation = bind_actuation(entry, load_model(bundle))
    limits: dict[str, tuple[float, float]] = {}
    for actuator, (negative_nm, positive_nm) in zip(entry.actuators, actuation.limits_nm.tolist(), strict=True):
        so_far = limits.get(actuator.joint, (0.0, 0.0))
        limits[actuator.joint] = (so_far[0] + negative_nm, so_far[1] + positive_nm)
    return limits
