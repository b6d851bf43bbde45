"""The `senses` of a spec and of a manifest: a section for each registered sense."""

from mimoc.schema.components.senses import SENSES
from mimoc.schema.composition import ComposedModel, composed, section_field


@composed(lambda: {kind.name: section_field(kind.spec) for kind in SENSES.values()})
class SensesSpec(ComposedModel):
    """The senses of the infant; a sense that is not listed is off."""


@composed(lambda: {kind.name: section_field(kind.entry) for kind in SENSES.values()})
class SensesEntry(ComposedModel):
    """The senses of the infant; a sense that is None is off."""
