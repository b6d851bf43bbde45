"""The child of a spec, or the key of the spec because of which there is none."""

from mimoc.body import GrownBody, grow_body
from mimoc.body.reference import Reference
from mimoc.compiler.diagnosis import diagnose
from mimoc.errors import GeometryError, IndividualError, SpecError
from mimoc.schema.infant import InfantSpec, as_written


def child_of(spec: InfantSpec, reference: Reference | None = None) -> GrownBody:
    """Return the body of a spec's child.

    Args:
        spec: The spec.
        reference: What children of the same anatomy are compared with, if it is known.

    Raises:
        SpecError: If there is no such child; the error says which key makes it impossible, and what would be possible.
    """
    try:
        return grow_body(spec, reference)
    except (GeometryError, IndividualError) as error:
        raise SpecError([diagnose(error, spec, as_written(spec))]) from None
