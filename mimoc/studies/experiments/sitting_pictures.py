"""Pictures of infants that try to sit."""

from contextlib import closing
from dataclasses import dataclass

import mujoco

from mimoc.compiler.validation.requests import ROOT
from mimoc.render.body_camera import STILL, BodyCamera
from mimoc.render.renderer import Picture
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.milestones import TRIALS, Conditions, Outcome, compile_at
from mimoc.studies.milestones.trial import Attempt, simulate

PICTURE_PX = (150, 150)


@dataclass(frozen=True)
class Sitter:
    """An infant that has tried to sit."""

    development: Development
    age_months: float
    outcome: Outcome
    """Of the attempt that lasted longest."""
    picture: Picture
    """At its end, shape (height, width, 3)."""


def try_to_sit(development: Development, age_months: float) -> Sitter:
    """Let the average child of an age try to sit, and return how its longest attempt ended.

    Raises:
        RenderingError: If OpenGL is not available.
    """
    spec = InfantSpec(mimoc=1, name="average_child", age_months=age_months, development=development)
    infant = compile_at(spec, age_months, Conditions())
    best, outcome = mujoco.MjData(infant.model), Outcome(False, -1.0)
    for attempt in TRIALS["sit"].attempts(infant):
        data, ended = _end(attempt)
        if ended.seconds > outcome.seconds:
            best, outcome = data, ended
        if outcome.success:
            break
    with closing(BodyCamera(infant.model, [ROOT], *PICTURE_PX, supersample=STILL)) as camera:
        return Sitter(development, age_months, outcome, camera.render(best))


def caption(sitter: Sitter) -> str:
    """Return the age of an infant, and how long it sat."""
    held = "sits" if sitter.outcome.success else f"falls after {sitter.outcome.seconds:.1f} s"
    return f"{sitter.age_months:g} months: {held}"


def _end(attempt: Attempt) -> tuple[mujoco.MjData, Outcome]:
    """Return the last state of an attempt, and its outcome."""
    last = mujoco.MjData(attempt.infant.model)

    def keep(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        mujoco.mj_copyData(last, model, data)

    outcome = simulate(attempt, Conditions(), keep)
    return last, outcome
