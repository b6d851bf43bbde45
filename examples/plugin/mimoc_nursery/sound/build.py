"""Two ears on the sides of the head."""

from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.elements import Site
from mimoc.compiler.mjcf.scene import Placed
from mimoc_nursery.sound.spec import SoundEntry, SoundSpec

LEFT, RIGHT = "sound_left_ear", "sound_right_ear"
SITE_RADIUS_M = 0.004
"""Only for looking at."""


def build(spec: SoundSpec, body: BodyTree) -> Placed:
    """Return the entry, and a site at each ear: where the widest part of the head is."""
    head = body.geoms["head"]
    x, y, z = head.pos_m
    radius_m = head.size_m[0]
    ears = (Site(LEFT, (x, y + radius_m, z), SITE_RADIUS_M), Site(RIGHT, (x, y - radius_m, z), SITE_RADIUS_M))
    entry = SoundEntry(
        left_ear=LEFT,
        right_ear=RIGHT,
        head="head",
        sources=spec.sources,
        level_db=spec.level_db,
        head_shadow_db=spec.head_shadow_db,
    )
    origin = {"value": spec.level_db, "unit": "dB", "rule": "given by the spec", "from": ["spec.senses.sound.level_db"]}
    return Placed(entry, sites={"head": ears}, origins={"sound.level_db": origin})
