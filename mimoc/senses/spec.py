"""The `senses` of a spec and of a manifest: a section for each registered sense."""

from typing import TYPE_CHECKING, Any

from mimoc.schema.base import Model
from mimoc.schema.composition import composed, section_field
from mimoc.senses import SENSES


@composed(lambda: {kind.name: section_field(kind.spec) for kind in SENSES.values()})
class SensesSpec(Model):
    """The senses of the infant; a sense that is not listed is off."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return the section of a sense, or None if it is off."""


@composed(lambda: {kind.name: section_field(kind.entry) for kind in SENSES.values()})
class SensesEntry(Model):
    """The senses of the infant; a sense that is None is off."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return the entry of a sense, or None if it is off."""
