"""Names of objects in the MJCF, which no part of an infant, scene or task has."""


def object_name(name: str) -> str:
    """Return the name of an object's outermost body, with which the names of all else of it begin."""
    return f"object_{name}"
