"""The child of a spec, or the key of the spec because of which there is none."""

from mimoc import body, fits
from mimoc.compiler.diagnosis import diagnose
from mimoc.errors import GeometryError, IndividualError, SpecError
from mimoc.schema.infant import InfantSpec, as_written


def child_of(spec: InfantSpec) -> tuple[body.Anatomy, fits.Measurements, body.BodyTree]:
    """Return anatomy, measurements and body of a spec's child.

    Raises:
        SpecError: If there is no such child; the error says which key makes it impossible, and what would be possible.
    """
    anatomy = body.assemble(spec.body.hands, spec.body.chest_joint)
    try:
        measurements = body.measure_child(spec, anatomy)
        return anatomy, measurements, body.grow_child(spec, measurements, anatomy)
    except (GeometryError, IndividualError) as error:
        raise SpecError([diagnose(error, spec, as_written(spec))]) from None
