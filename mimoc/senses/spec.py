"""The `senses` of a spec and of a manifest: a section for each sense there is."""

from typing import TYPE_CHECKING, Any

from mimoc.schema.base import Model
from mimoc.schema.composition import composed, section_field
from mimoc.senses import SENSES


@composed(lambda: {kind.name: section_field(kind.spec) for kind in SENSES.values()})
class SensesSpec(Model):
    """The senses an infant has; one that is not named is off."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return what is asked of a sense, or None."""


@composed(lambda: {kind.name: section_field(kind.entry) for kind in SENSES.values()})
class SensesEntry(Model):
    """The senses of the infant; one that is None is off."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return what the runtime knows of a sense, or None."""
