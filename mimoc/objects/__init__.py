"""Objects at places of the user's choice; each kind is a folder."""

from mimoc.base.kinds import Kinds, ObjectKind

OBJECTS: Kinds[ObjectKind] = Kinds("kind of object", {"shape": "mimoc.objects.shape"})
