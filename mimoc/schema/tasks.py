"""What an infant is to achieve."""

from typing import Literal

from mimoc.schema.base import Model


class TaskSpec(Model):
    """A goal with its reward and its end."""

    kind: Literal["reach", "standup", "selfbody", "catch", "rollover", "free"]
    """Touch a ball, stand up, touch a part of oneself, catch a ball, turn over, or nothing at all."""
