"""Vision on a body."""

from collections.abc import Iterator

from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf import sensor_sites
from mimoc.compiler.mjcf.scene import Placed
from mimoc.components.senses.vision import VisionEntry, VisionSpec
from mimoc.components.senses.vision.build_acuity import resolve_acuity
from mimoc.components.senses.vision.build_maturity import UNITS, maturity_of, rules_of

PROFILES = {
    "tac2": "log2 of acuity = -.1839 ln²t + 1.8235 ln t - .5889 at t months, fitted to Mayer et al. 1995 and Salomão & "
    "Ventura 1995 on the scale of the TAC II (Neijzen et al. 2025)",
    "mayer1995": "Mayer et al. 1995, log acuity interpolated over log age",
    "mimo_v2": "the figures of MIMo v2, log acuity interpolated over log age",
}
"""What each acuity profile goes by."""


def build(spec: VisionSpec, body: BodyTree) -> Placed:
    """Return the entry, and the cameras of the eyes with the field of view that is asked for."""
    cameras = sensor_sites.cameras(body, spec.fovy_deg)
    names = {part.name for part in body.bodies}
    fields = {"contrast": "linear", "foveation": spec.foveation} | maturity_of(spec, body.age_months)
    left = dict(body.acuity)
    entry = VisionEntry(
        cameras=tuple(camera.name for eye in cameras.values() for camera in eye),
        width_px=spec.width_px,
        height_px=spec.height_px,
        supersample=spec.supersample,
        acuity_cpd=resolve_acuity(spec, body.age_months),
        acuity_shares=tuple(left.get(eye, 1.0) for eye in cameras) if left else (),
        field_deg=dict(body.field_deg),
        foveation_radius=spec.foveation_radius,
        unseen=tuple(name for name in sensor_sites.UNSEEN if name in names),
        # By the published law, eyes see solids unless the spec asks for skins.
        body="solids" if spec.body is None and body.development == "published" else spec.body,
        **fields,
    )
    return Placed(entry, cameras=cameras, origins=_origins(spec, entry))


def _origins(spec: VisionSpec, entry: VisionEntry) -> dict[str, dict[str, object]]:
    origins = dict(_impaired(entry)) | dict(_matured(spec, entry))
    if entry.acuity_cpd is None:
        return origins
    if isinstance(spec.acuity, (int, float, str)):
        rule = PROFILES[spec.acuity_profile]
        sources = ["spec.senses.vision.acuity", "spec.senses.vision.acuity_profile", "spec.age_months"]
    else:
        rule, sources = "given by the spec", ["spec.senses.vision.acuity.cpd"]
    origin = {"value": entry.acuity_cpd, "unit": "cycles/deg", "rule": rule, "from": sources}
    return {"vision.acuity_cpd": origin, **origins}


def _matured(spec: VisionSpec, entry: VisionEntry) -> Iterator[tuple[str, dict[str, object]]]:
    """Yield the origins of what is as mature as at some age."""
    for name, rule, keys in rules_of(spec):
        unit, sources = UNITS.get(name, "1"), [f"spec.senses.vision.{key}" for key in keys]
        yield (
            f"vision.{name}",
            {"value": getattr(entry, name), "unit": unit, "rule": rule, "from": [*sources, "spec.age_months"]},
        )


def _impaired(entry: VisionEntry) -> Iterator[tuple[str, dict[str, object]]]:
    rule = "given by the spec"
    if entry.acuity_shares:
        yield (
            "vision.acuity_shares",
            {"value": list(entry.acuity_shares), "unit": "1", "rule": f"{rule}: impairments.acuity"},
        )
    for direction, angle_deg in entry.field_deg.items():
        at = [f"spec.impairments.field_deg.{direction}"]
        yield f"vision.field_deg.{direction}", {"value": angle_deg, "unit": "deg", "rule": rule, "from": at}
