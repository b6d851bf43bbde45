"""What can be asked of wooden blocks."""

from typing import Annotated

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.quantities import Real


class BlocksSpec(Model):
    """The wood of the blocks."""

    density_kg_m3: Annotated[Real, Field(gt=100, lt=1500)] = 700.0
    """Density; beech has about 700 kg/m³."""
