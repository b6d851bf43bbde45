"""The digest of the bodies that figures of a study were measured with, which figures that ship with mimoc carry."""

from collections.abc import Iterable
from hashlib import sha256
from xml.etree.ElementTree import canonicalize

from mimoc.bundle.io import Bundle
from mimoc.compiler.pipeline import compiled
from mimoc.schema.infant import InfantSpec

STILL = {"asset", "camera", "deformable", "light", "sensor", "site", "statistic", "visual"}
"""Elements of MJCF that move nothing: how a scene looks, and what is only read."""
NAMES = {"model", "material", "rgba", "group"}
"""Attributes that move nothing: the name of the infant, and how a geom looks."""
DIGITS = 16


def bodies_digest(infants: Iterable[Bundle | InfantSpec]) -> str:
    """Return 16 hexadecimal digits that say with which bodies something was measured.

    They are those of the scenes that are simulated, in the order given: masses, shapes, joints, motors, contacts, start
    poses and furniture, with the digits of bundles, which are the same on every machine. Names of infants, looks,
    sensors and sites, manifests and versions are left out.

    Raises:
        SpecError: If an infant cannot be built.

    Example:
        >>> from mimoc.compiler.loading import load_spec
        >>> spec = load_spec("nine_months.yaml")
        >>> bodies_digest([spec]) == bodies_digest([spec.with_(name="another")])
        True
        >>> bodies_digest([spec]) == bodies_digest([spec.with_(age_months=10)])
        False
    """
    digest = sha256()
    for bundle in map(compiled, infants):
        scene = bundle.files[bundle.manifest.scene].decode()
        moved = canonicalize(scene, strip_text=True, exclude_tags=STILL, exclude_attrs=NAMES)
        digest.update(moved.encode())
    return digest.hexdigest()[:DIGITS]
