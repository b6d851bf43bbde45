"""What elements of a scene refer to by name, and whether it is still there when the infant is mimoc's."""

from collections.abc import Iterator, Mapping

import mujoco

from mimoc.compat.import_mimo.reading import Element

KINDS: Mapping[str, str] = {
    **dict.fromkeys(("body", "body1", "body2"), "body"),
    **dict.fromkeys(("joint", "joint1", "joint2", "jointinparent"), "joint"),
    **dict.fromkeys(("geom", "geom1", "geom2"), "geom"),
    **dict.fromkeys(("site", "site1", "site2", "refsite", "slidersite", "cranksite", "sidesite"), "site"),
    **dict.fromkeys(("tendon", "tendon1", "tendon2"), "tendon"),
    "target": "body",
    "actuator": "actuator",
    "camera": "camera",
}
"""Kind of what an attribute names."""
TYPED = {"objname": "objtype", "refname": "reftype"}
"""Attributes that name something, and those with its kind."""
SAME = {"xbody": "body", "freejoint": "joint"}
"""Kind of what has another word."""
LISTS = ("flex", "skin")
"""Elements whose attributes of these names are lists."""
Names = dict[str, set[str]]


def names_in_model(model: mujoco.MjModel) -> Names:
    """Return the names in a compiled model, by kind."""
    counts = {
        "body": model.nbody,
        "joint": model.njnt,
        "geom": model.ngeom,
        "site": model.nsite,
        "camera": model.ncam,
        "tendon": model.ntendon,
        "actuator": model.nu,
        "sensor": model.nsensor,
        "material": model.nmat,
        "texture": model.ntex,
    }
    return {kind: {getattr(model, kind)(index).name for index in range(count)} for kind, count in counts.items()}


def names_in(sections: list[Element], names: Names) -> Names:
    """Return *names* and those of what is in the sections of a scene, by kind."""
    result = {kind: set(of_kind) for kind, of_kind in names.items()}
    for section in sections:
        for element in section.walk() if section.tag in ("worldbody", "tendon", "actuator") else ():
            kind = SAME.get(element.tag, element.tag) if section.tag == "worldbody" else section.tag
            if element.get("name") and kind in result:
                result[kind].add(element.get("name"))
    return result


def references(element: Element) -> Iterator[tuple[str, str]]:
    """Yield the attributes of an element, but not of those below it, that name something, and of which kind."""
    for name in element.attributes:
        if name in TYPED:
            kind = element.get(TYPED[name])
            yield name, SAME.get(kind, kind)
        elif name in KINDS and element.tag not in LISTS:
            yield name, KINDS[name]


def resolved(element: Element, names: Names, others: Mapping[tuple[str, str], str]) -> tuple[Element, list[str]]:
    """Return an element, with those below it, whose references lead to what has the name now, and what is gone."""
    attributes, missing = dict(element.attributes), list[str]()
    for attribute, kind in references(element):
        name = attributes[attribute]
        new = name if name in names.get(kind, ()) else others.get((kind, name), name)
        attributes[attribute] = new
        if kind in names and new not in names[kind] and new != "world":
            missing.append(f"{kind} '{name}'")
    pairs = [resolved(child, names, others) for child in element.children]
    children, below = [child for child, _ in pairs], [name for _, lost in pairs for name in lost]
    return Element(element.tag, attributes, element.file, element.line, children), missing + below
