"""The recoil of a bent elbow that was stretched for a while, as in the examination of newborns."""

import mujoco

from mimoc.base.quantities import Quantity
from mimoc.studies.movement.drive import QUIET, again, angle_deg, run, settled
from mimoc.studies.movement.trial import MovementTrial, Subject, Values

STRETCHED_S = 2.0  # How long the elbow is held stretched.
WAITED_S = 2.0  # After which time the angle is read.
ELBOW = "left_elbow"


def _measure(subject: Subject) -> Values:
    infant, start = subject.infant, settled(subject.infant)
    model = infant.model
    holding = infant.fixed([int(model.joint(f"robot:{ELBOW}").dofadr[0])])
    held = again(holding, start, moving=False)
    held.qpos[model.joint(f"robot:{ELBOW}").qposadr[0]] = model.joint(f"robot:{ELBOW}").range[1]
    mujoco.mj_forward(holding.model, held)
    run(holding, held, STRETCHED_S, QUIET)
    stretched_deg = angle_deg(infant, held, ELBOW)
    free = again(infant, held, moving=False)
    run(infant, free, WAITED_S, QUIET)
    return {"recoil_deg": stretched_deg - angle_deg(infant, free, ELBOW)}


RECOIL = MovementTrial(
    "recoil",
    "on its back and quiet, an elbow is held stretched for 2 s and let go: how far it has bent after 2 s",
    _measure,
    (0.0, 1.0, 3.0, 6.0, 9.0),
    (Quantity("recoil_deg", "Recoil of the elbow", "deg"),),
    ("left_lower_arm",),
    side="left",
)
