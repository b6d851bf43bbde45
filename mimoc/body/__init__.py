"""The body: from measurements to a body tree with masses, joints and strengths."""

from typing import TYPE_CHECKING

from mimoc.base.lazy import names_of

if TYPE_CHECKING:
    from mimoc.body.anatomy import assemble as assemble
    from mimoc.body.grow import (
        GrownBody as GrownBody,
        grow_average as grow_average,
        grow_body as grow_body,
        grow_tree as grow_tree,
    )
    from mimoc.body.tree import (
        FREE_JOINT as FREE_JOINT,
        Body as Body,
        BodyTree as BodyTree,
        Geom as Geom,
        Joint as Joint,
        Motor as Motor,
        Tendon as Tendon,
    )

__getattr__, __dir__, __all__ = names_of(__name__)
