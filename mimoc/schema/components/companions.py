"""Companions that come with mimoc, by name."""

from collections.abc import Mapping

from mimoc.base.kinds import Code

COMPANIONS: Mapping[str, Code] = {"caregiver": "mimoc.components.companions.caregiver.run"}
"""`bind() -> Companion`, or the module that has it. An infant has one if its manifest has an entry of that name."""
