"""The world around an infant: the kinds of scenes, a folder each."""

from mimoc.kinds import Kinds, SceneKind, by_name
from mimoc.scenes.crib import CRIB
from mimoc.scenes.empty import EMPTY
from mimoc.scenes.flat import FLAT
from mimoc.scenes.room import ROOM

SCENES: Kinds[SceneKind] = Kinds("kind of scene", by_name((EMPTY, FLAT, CRIB, ROOM)))
