"""All reflexes.

Ages and responses are those that textbooks give; `source` says which were read in a secondary source, and which are
from memory and still to be checked. No source gives thresholds, gains by age, or how strong responses are: these are
ours, and stand beside what they are of.
"""

from collections.abc import Mapping

from mimoc.policies.reflexes import grasping, legs, moro, neck, protective
from mimoc.policies.reflexes.reflex import AgeWindow, Reflex

_ALL = (
    Reflex(
        "palmar_grasp",
        "pressure in the palm",
        "fingers close, and tighten when they are pulled",
        AgeWindow(loss_months=(3, 6)),
        ("touch",),
        "secondary sources: 3-4, and 4-6 months",
        grasping.palmar_grasp,
        grasping.PALMAR,
    ),
    Reflex(
        "plantar_grasp",
        "pressure on the ball of the foot",
        "toes curl",
        AgeWindow(loss_months=(6, 12)),
        ("touch",),
        "secondary sources",
        grasping.plantar_grasp,
        grasping.PLANTAR,
    ),
    Reflex(
        "moro",
        "the head drops back, or all of the body falls",
        "arms spread, elbows and fingers straighten (.3-.5 s), then arms come back and bend (1-2 s)",
        AgeWindow(loss_months=(4, 6)),
        ("vestibular",),
        "secondary sources; times from memory",
        moro.moro,
        moro.START,
    ),
    Reflex(
        "tonic_neck",
        "supine, the head turned to a side (asymmetric tonic neck reflex)",
        "arm and leg of the face's side straighten, the others bend, 40 % of the time",
        AgeWindow(onset_months=(-1, 1), loss_months=(4, 7)),
        ("proprioception", "vestibular"),
        "secondary sources; share of time, and that it is strongest at 1-3 months, from memory",
        neck.tonic_neck,
        neck.TONIC_NECK,
    ),
    Reflex(
        "rooting",
        "touch at the cheek",
        "the head turns there, by 20-40 degrees",
        AgeWindow(loss_months=(3, 4)),
        ("touch",),
        "secondary sources",
        neck.rooting,
        neck.ROOTING_START,
    ),
    Reflex(
        "stepping",
        "held upright, soles on a surface",
        "legs lift in turn, 5-20 steps a minute",
        AgeWindow(loss_months=(2, 4)),
        ("touch", "vestibular"),
        "secondary sources; steps a minute from memory",
        legs.stepping,
        legs.STEPPING,
    ),
    Reflex(
        "placing",
        "held upright, the back of a foot touches an edge",
        "hip and knee bend, and the foot is put down on top",
        AgeWindow(loss_months=(2, 4)),
        ("touch", "vestibular"),
        "secondary sources; ages vary",
        legs.placing,
        legs.PLACING,
    ),
    Reflex(
        "protective_forwards",
        "tipping forwards from sitting",
        "arms stretch forwards, fingers open",
        AgeWindow(onset_months=(6, 9)),
        ("vestibular",),
        "memory; secondary sources say 4-6 months",
        protective.forwards,
        protective.ONE,
    ),
    Reflex(
        "protective_sideways",
        "tipping to a side from sitting",
        "the arm of that side stretches, fingers open",
        AgeWindow(onset_months=(6, 7)),
        ("vestibular",),
        "memory",
        protective.sideways,
        protective.BOTH,
    ),
    Reflex(
        "protective_backwards",
        "tipping backwards from sitting",
        "arms stretch backwards, fingers open",
        AgeWindow(onset_months=(8, 10)),
        ("vestibular",),
        "memory",
        protective.backwards,
        protective.ONE,
    ),
)
REFLEXES: Mapping[str, Reflex] = {reflex.name: reflex for reflex in _ALL}
