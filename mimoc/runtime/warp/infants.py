"""Single environments that draw the starts of infants on a device."""

from collections.abc import Mapping
from types import MappingProxyType

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.vision.sight import VISION, ClosedEyes
from mimoc.senses.sense import Sense


class StartingInfant(InfantEnv):
    """An infant whose eyes are closed, so that it needs no OpenGL: what it sees is drawn on the device."""

    def _bind(self, former: Mapping[str, Sense] = MappingProxyType({})) -> None:
        """Bind everything but vision."""
        super()._bind({VISION: ClosedEyes(), **former})
