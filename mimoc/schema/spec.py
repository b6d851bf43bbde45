"""The whole of what a user says about one infant in one world."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, StringConstraints, model_validator

from mimoc.actuation.spec import ActuationSpec
from mimoc.delays.spec import DelaysSpec
from mimoc.scenes.spec import SceneSpec
from mimoc.schema.base import KeyedError, Model
from mimoc.schema.body import BodySpec
from mimoc.schema.control import ControlSpec
from mimoc.schema.quantities import Age
from mimoc.senses.spec import SensesSpec
from mimoc.tasks.spec import TaskSpec
from mimoc.units import to_steps


def _known_version(value: Any) -> Any:
    if type(value) is not int or value != 1:
        raise ValueError("this mimoc reads version 1 of the spec language; write 'mimoc: 1'")
    return value


PLACES: Mapping[str, tuple[str, ...]] = {
    "standup": ("flat",),
    "catch": ("flat", "crib", "room"),
    "rollover": ("flat", "crib", "room"),
}
"""The kinds of scenes for tasks that cannot be in all: a rail stands on an open floor, and what falls or lies needs
weight and a floor."""
LYING = ("supine", "prone")
"""The poses that `rollover` can start from."""


class InfantKeys(Model):
    """All keys of the spec language, and what holds between them."""

    mimoc: Annotated[Literal[1], BeforeValidator(_known_version), Field(examples=[1])]
    """Version of the spec language."""
    name: Annotated[
        str, StringConstraints(strict=True, pattern="^[a-z][a-z0-9_]*$", max_length=64), Field(examples=["my_infant"])
    ]
    """Name of the infant, and of its model."""
    age_months: Annotated[Age, Field(examples=[9])]
    """Age of the body."""
    body: BodySpec = Field(default_factory=BodySpec)
    """The body."""
    actuation: ActuationSpec = Field(default_factory=ActuationSpec)
    """What moves it."""
    senses: SensesSpec = Field(default_factory=SensesSpec)
    """What it perceives."""
    delays: DelaysSpec = Field(default_factory=DelaysSpec)
    """How late it perceives and moves."""
    scene: SceneSpec = Field(default_factory=SceneSpec)
    """The world it is in."""
    control: ControlSpec = Field(default_factory=ControlSpec)
    """The clock."""
    task: TaskSpec | None = None
    """What it is to achieve; left out, nothing."""

    @model_validator(mode="after")
    def _vision_has_eyes(self) -> Self:
        if self.senses.vision and {"left_eye", "right_eye"} <= set(self.body.remove):
            message = "an infant without eyes cannot see; leave it out, or keep an eye"
            raise KeyedError(("senses", "vision"), message, against=("body", "remove"))
        return self

    @model_validator(mode="after")
    def _task_has_its_place(self) -> Self:
        kind = self.task.kind if self.task else ""
        places = PLACES.get(kind, (self.scene.kind,))
        if self.scene.kind not in places:
            possible = ", ".join(places).replace(", room", " or room")
            message = f"'{kind}' has no place in such a scene; use {possible}, or another task"
            raise KeyedError(("scene", "kind"), message, against=("task", "kind"))
        if kind == "rollover" and self.scene.pose not in LYING:
            message = f"'{kind}' starts {' or '.join(LYING)}, not {self.scene.pose}; use one of these"
            raise KeyedError(("scene", "pose"), message, against=("task", "kind"))
        return self

    @model_validator(mode="after")
    def _delays_are_whole_steps(self) -> Self:
        for key, delay_ms in self.delays:
            if not isinstance(delay_ms, float):
                continue
            try:
                to_steps(delay_ms, self.control.timestep_ms)
            except ValueError as error:
                raise KeyedError(("delays", key), f"a delay of {error}", against=("control", "timestep_ms")) from None
        return self
