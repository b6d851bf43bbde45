"""The `senses` of a spec and of a manifest: a section for each registered sense."""

from mimoc.schema.composition import ComposedModel, composed, section_field
from mimoc.senses import SENSES


@composed(lambda: {kind.name: section_field(kind.spec) for kind in SENSES.values()})
class SensesSpec(ComposedModel):
    """The senses of the infant; a sense that is not listed is off."""


@composed(lambda: {kind.name: section_field(kind.entry) for kind in SENSES.values()})
class SensesEntry(ComposedModel):
    """The senses of the infant; a sense that is None is off."""
