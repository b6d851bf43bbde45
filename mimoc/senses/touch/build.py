"""Touch on a body."""

from mimoc.body import BodyTree
from mimoc.mjcf.placed import Placed
from mimoc.senses.touch.skin_points import grow_skin
from mimoc.senses.touch.spec import TouchEntry, TouchSpec

SPACING_RULE = "two-point discrimination there at 18 months (MIMo) / sqrt(density), grown with the body's skin"


def build(spec: TouchSpec, body: BodyTree) -> Placed:
    """Return the entry, with the skin points of the body; nothing stands for them in the MJCF."""
    skin = grow_skin(body, spec.density, spec.regions)
    entry = TouchEntry(
        quantity=spec.quantity,
        response=spec.response,
        points_m={name: tuple((x, y, z) for x, y, z in points.tolist()) for name, points in skin.points_m.items()},
        spacing_m=dict(skin.spacing_m),
    )
    sources = ["spec.senses.touch.density", "spec.age_months"]
    origins = {
        f"skin.{name}.spacing": {"value": spacing_m, "unit": "m", "rule": SPACING_RULE, "from": sources}
        for name, spacing_m in skin.spacing_m.items()
    }
    return Placed(entry, origins=origins)
