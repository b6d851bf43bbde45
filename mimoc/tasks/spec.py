"""What an infant is to achieve."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from mimoc.schema.base import KeyedError, Model
from mimoc.schema.quantities import Whole

HANDED = ("reach", "selfbody", "catch")
"""Tasks of one hand."""


class TaskSpec(Model):
    """A goal with its reward and its end."""

    kind: Literal["reach", "standup", "selfbody", "catch", "rollover", "free"]
    """Touch a ball, stand up, touch a part of oneself, catch a ball, turn over, or nothing at all."""
    steps: Annotated[Whole, Field(ge=1, le=10**9)] | None = None
    """Control steps of an episode; left out, as many as MIMo's task has, and `free` has no end."""
    hand: Literal["right", "left"] | None = None
    """The hand that reaches, touches or catches; left out, the right one."""
    reward: Literal["dense", "shaped"] | None = None
    """Of `rollover`: for how far the infant has turned, at every step (`dense`, if left out), or for success, shaped by
    how much farther it has turned in each step."""

    @model_validator(mode="after")
    def _has_what_belongs_to_it(self) -> Self:
        for key, kinds in (("hand", HANDED), ("reward", ("rollover",))):
            if getattr(self, key) is not None and self.kind not in kinds:
                message = f"'{self.kind}' has no such choice; leave it out (it belongs to {', '.join(kinds)})"
                raise KeyedError((key,), message, against=("kind",))
        return self
