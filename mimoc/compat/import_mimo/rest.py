"""The rest of a MIMo scene: what is left without the infant, which is attached from the bundle of its spec instead."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import PurePosixPath
from xml.etree import ElementTree

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import Problem
from mimoc.base.geometry.rotations import matrix_from_quaternion
from mimoc.body.tree import FREE_JOINT
from mimoc.compat.import_mimo.comparison import PREFIX, Names
from mimoc.compat.import_mimo.infant import HIP, Infant, held_parts
from mimoc.compat.import_mimo.reading import Element

REFERRING = ("contact", "tendon", "equality", "actuator", "sensor")
"""Sections whose elements refer to bodies and joints; tendons before the others, which may refer to them."""
MODEL = "infant"
RENAMED = "scene_"  # Prefix of assets that have the name of one of the infant's.


@dataclass(frozen=True)
class Rest:
    """The rest of a scene."""

    tree: Element  # What is left of it; the files of its assets are still those of the source.
    notes: tuple[Problem, ...]  # What was not taken over.


def rest_of(infant: Infant, model: mujoco.MjModel, mjcf: bytes, mimocs: mujoco.MjModel, names: Names) -> Rest:
    """Return what is left of a scene without its infant, with the options of mimoc's infant."""
    notes = list(_strangers(infant, names))
    option, size = _options(mjcf)
    drop = {"option": option.attributes, "flag": option.children[0].attributes, "size": size.attributes}
    # The frame in which the hip of mimoc's infant is where that of the scene is.
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    hip, quat = data.body(HIP).xpos, data.body(HIP).xquat
    root = mujoco.MjData(mimocs)
    mujoco.mj_kinematics(mimocs, root)
    pos = hip - matrix_from_quaternion(tuple(quat)) @ root.body(HIP).xpos
    attributes = {"pos": _numbers(pos)} | ({} if np.allclose(quat, (1, 0, 0, 0)) else {"quat": _numbers(quat)})
    frame = Element("frame", attributes, children=[Element("attach", {"model": MODEL, "prefix": ""})])
    sections = [_without(section, infant, frame, drop, notes) for section in infant.tree.children]
    sections = _referring(sections, infant, names, notes)
    sections = _with_assets(_with_defaults(sections, infant), infant, names)
    sections = [section for section in sections if section.children or section.attributes]
    size.attributes["nuser_actuator"] = str(max(model.nuser_actuator, mimocs.nuser_actuator))
    return Rest(Element("mujoco", infant.tree.attributes, children=[*sections, option, size]), tuple(notes))


def _options(mjcf: bytes) -> tuple[Element, Element]:
    root = ElementTree.fromstring(mjcf)
    (option,), (size,) = root.findall("option"), root.findall("size")
    flags = [Element(flag.tag, dict(flag.attrib)) for flag in option]
    return Element("option", dict(option.attrib), children=flags), Element("size", dict(size.attrib))


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{round(float(value), 9) + 0.0:.9g}" for value in values)


def _without(
    section: Element, infant: Infant, frame: Element, drop: Mapping[str, Mapping[str, str]], notes: list[Problem]
) -> Element:
    """Return a section of the scene without the infant, whose place a frame takes, and without attributes to drop."""
    attributes = {name: value for name, value in section.attributes.items() if name not in drop.get(section.tag, {})}
    children = section.children
    if section.tag == "option":
        children = [_without(child, infant, frame, drop, notes) for child in children]
    elif section.tag == "keyframe":
        children, attributes = [], {}
    elif section.tag == "worldbody":
        children = [part for child in children for part in _placed(child, infant, frame, notes)]
    return replace(section, attributes=attributes, children=children)


def _placed(element: Element, infant: Infant, frame: Element, notes: list[Problem]) -> Iterator[Element]:
    """Yield what stays of an element of the world: all but the infant, and what is fixed to a body that it moves."""
    if element not in infant.chain:
        yield element
        return
    if infant.free_joint is None:
        if stays := _pruned(element, infant.hip):
            yield stays
    else:
        moving = next(part for part in infant.chain if infant.free_joint in part.children)
        around = [part for part in moving.walk() if part in infant.chain]
        notes += [
            child.problem(f"not taken over: it is fixed to '{part.get('name')}', which mimoc's infant does not have")
            for part in around
            for child in part.children
            if part is not infant.hip and child not in (*infant.chain, infant.free_joint) and child.tag != "inertial"
        ]
        if element is not moving and (stays := _pruned(element, moving)):
            yield stays
    yield frame


def _pruned(element: Element, gone: Element) -> Element | None:
    """Return an element without another, which is or is below it; None if it is that."""
    if element is gone:
        return None
    children = [part for child in element.children if (part := _pruned(child, gone))]
    return replace(element, children=children)


def _strangers(infant: Infant, names: Names) -> Iterator[Problem]:
    """Yield notes on what is on the infant and not MIMo's, and on parts that hang on others."""
    for name, body in infant.bodies.items():
        if name not in infant.parents:
            yield body.problem("not taken over: it is on the infant, and no part of MIMo's")
            continue
        geoms = [child for child in body.children if child.tag == "geom"]
        for child in body.children:
            title = child.get("name")
            if child.tag == "geom":
                title = title.removeprefix(PREFIX) or f"{name}{geoms.index(child) + 1}"
                title = title if title in names["geom"] else f"{title}1"
            known = infant.hinges if child.tag == "joint" else names.get(child.tag, set[str]())
            if child.tag in ("joint", "geom", "site", "camera", "light") and title not in known:
                yield child.problem(f"not taken over: mimoc's infant has no such {child.tag} on '{name}'")
            elif child.tag == "body" and infant.parents.get(title, name) != name:
                yield child.problem(f"it hangs on '{name}'; in mimoc's infant, it hangs on '{infant.parents[title]}'")


def _referring(sections: list[Element], infant: Infant, names: Names, notes: list[Problem]) -> list[Element]:
    """Return sections whose elements refer to what there is: those of the infant's are left out, others noted."""
    known = names_in(sections, names)
    others = {("geom", PREFIX + name): name for name in names["geom"]}
    if infant.free_joint is not None:
        others["joint", infant.free_joint.get("name")] = FREE_JOINT
        others |= {("body", part.get("name")): HIP for part in infant.chain if part.tag == "body"}
    result: list[Element] = []
    for section in sections:
        if section.tag not in ("worldbody", *REFERRING):
            result.append(section)
            continue
        children: list[Element] = []
        for child in section.children:
            if section.tag != "worldbody" and _is_infants(section.tag, child, infant, names):
                continue
            changed, missing = resolved(child, known, others)
            if missing:
                notes.append(child.problem(f"not taken over: mimoc's infant has no {' and no '.join(missing)}"))
            else:
                children.append(changed)
        result.append(replace(section, children=children))
    if infant.free_joint is None and held_parts(infant):
        home = {"body2": infant.home.get("name")} if infant.home and infant.home.get("name") else {}
        result.append(Element("equality", {}, children=[Element("weld", {"body1": HIP, **home})]))
    return [section for section in result if section.children or section.tag not in REFERRING]


def _is_infants(section: str, element: Element, infant: Infant, names: Names) -> bool:
    name = element.get("name")
    if section == "actuator":
        return name in names["actuator"] or name in infant.motors
    if section in ("sensor", "tendon"):
        return name in names[section]
    if section == "contact":
        of_infant = {geom.get("name") for geom in infant.hip.walk() if geom.tag == "geom"} | set(infant.bodies)
        return all(element.get(attribute) in of_infant for attribute, _ in references(element))
    return False


def _with_defaults(sections: list[Element], infant: Infant) -> list[Element]:
    """Return sections without the default classes that only the infant uses."""
    used = {value for section in sections for value in _classes(section)}
    only = set(_classes(infant.hip)) - used

    def kept(default: Element) -> Element | None:
        children = [part for child in default.children if (part := kept(child) if child.tag == "default" else child)]
        if default.get("class") in only and not any(child.tag == "default" for child in children):
            return None
        return replace(default, children=children)

    return [part for section in sections if (part := kept(section) if section.tag == "default" else section)]


def _classes(element: Element) -> Iterator[str]:
    for part in element.walk():
        if part.tag != "default":
            yield from (part.get(name) for name in ("class", "childclass") if part.get(name))


def _with_assets(sections: list[Element], infant: Infant, names: Names) -> list[Element]:
    """Return sections without the assets of the infant; others whose names the infant has as well get new ones."""
    assets = [asset for section in sections if section.tag == "asset" for asset in section.children]
    defaults = {part.get("class"): part for section in infant.tree.children for part in section.walk()}
    of_infant = [infant.hip, *(defaults[name] for name in set(_classes(infant.hip)) if name in defaults)]
    mimocs = {(kind, name) for kind in ("material", "texture") for name in names[kind]}
    used = used_assets(section for section in sections if section.tag != "asset")
    kept = kept_assets(assets, used, used_assets(of_infant) | mimocs)
    clashing = {(asset.tag, asset.get("name")) for asset in kept} & mimocs
    renamed = {key: RENAMED + key[1] for key in clashing}
    result = []
    for section in sections:
        children = [child for child in section.children if section.tag != "asset" or child in kept]
        changed = replace(section, children=children)
        result.append(_renamed(changed, renamed))
    return result


def _renamed(element: Element, names: Mapping[tuple[str, str], str]) -> Element:
    if not names:
        return element
    new = {name: names.get((name, value), value) for name, value in element.attributes.items()}
    if (element.tag, element.get("name")) in names:
        new["name"] = names[element.tag, element.get("name")]
    children = [_renamed(child, names) for child in element.children]
    return replace(element, attributes=new, children=children)


USES = ("material", "texture", "mesh", "hfield")  # Attributes that name an asset.


def used_assets(elements: Iterable[Element]) -> set[tuple[str, str]]:
    """Return kind and name of the assets that elements use, such as the texture of a material."""
    return {use for element in elements for part in element.walk() for use in _uses(part)}


def _uses(element: Element) -> Iterator[tuple[str, str]]:
    for name in USES:
        if value := element.get(name):
            yield name, value
    if element.tag == "layer":
        yield "texture", element.get("texture")


def kept_assets(assets: list[Element], used: set[tuple[str, str]], infants: set[tuple[str, str]]) -> list[Element]:
    """Return the assets, given by kind and name, but for those that only the infant and not the rest *used*."""
    by_name = {_asset_name(asset): asset for asset in assets}
    only = _with_textures(infants, by_name) - _with_textures(used, by_name)
    of_others = _with_textures({name for name in by_name if name not in only}, by_name)
    return [asset for asset in assets if _asset_name(asset) not in only - of_others]


def _asset_name(element: Element) -> tuple[str, str]:
    """Return kind and name of an asset, which MuJoCo names after its file if it has no name."""
    return element.tag, element.get("name") or PurePosixPath(element.get("file")).stem


def _with_textures(names: set[tuple[str, str]], by_name: Mapping[tuple[str, str], Element]) -> set[tuple[str, str]]:
    return names | used_assets(by_name[name] for name in names if name in by_name)


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
TYPED = {"objname": "objtype", "refname": "reftype"}  # Attributes that name something, and those with its kind.
SAME = {"xbody": "body", "freejoint": "joint"}  # Kind of what has another word.
LISTS = ("flex", "skin")  # Elements whose attributes of these names are lists.


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
    children = [child for child, _ in pairs]
    below = [name for _, lost in pairs for name in lost]
    return replace(element, attributes=attributes, children=children), missing + below


POSITIONS, VELOCITIES = (7, 4, 1, 1), (6, 3, 1, 1)  # Numbers of a free joint, a ball joint, a slide and a hinge.


def moved_keyframes(infant: Infant, source: mujoco.MjModel, scene: mujoco.MjModel) -> Element:
    """Return the keyframes of a scene, *source*, for what was made of it, *scene*.

    Joints and actuators are found by their names, those without one by the body that they move. What only the latter
    has is where it is at the start, at rest and without a command. Commands keep their place within their range,
    which for servos is in radians in MIMo.
    """
    home = infant.free_joint
    renamed = {home.get("name"): FREE_JOINT, (infant.home or infant.hip).get("name"): HIP} if home else {}
    joints = list(_pairs(_joints(source), _joints(scene), renamed))
    motors = list(_pairs(_actuators(source), _actuators(scene), {}))
    keys = []
    for key in range(source.nkey):
        qpos, qvel, ctrl = np.array(scene.qpos0), np.zeros(scene.nv), np.zeros(scene.nu)
        for old, new in joints:
            kind = source.jnt_type[old]
            _copy(source.key_qpos[key], source.jnt_qposadr[old], qpos, scene.jnt_qposadr[new], POSITIONS[kind])
            _copy(source.key_qvel[key], source.jnt_dofadr[old], qvel, scene.jnt_dofadr[new], VELOCITIES[kind])
        for old, new in motors:
            ctrl[new] = np.interp(
                source.key_ctrl[key][old], source.actuator_ctrlrange[old], scene.actuator_ctrlrange[new]
            )
        values = {
            "qpos": qpos,
            "qvel": qvel,
            "ctrl": ctrl,
            "mpos": source.key_mpos[key],
            "mquat": source.key_mquat[key],
        }
        texts = {name: " ".join(f"{number:.9g}" for number in array) for name, array in values.items() if array.size}
        name = {"name": source.key(key).name} if source.key(key).name else {}
        keys.append(Element("key", {**name, "time": f"{source.key_time[key]:.9g}", **texts}))
    return Element("keyframe", {}, children=keys)


def _joints(model: mujoco.MjModel) -> dict[str, int]:
    names = dict[str, int]()
    for joint in range(model.njnt):
        body = model.jnt_bodyid[joint]
        number = joint - model.body_jntadr[body]
        names[model.joint(joint).name or f"{model.body(body).name}/{number}"] = joint
    return names


def _actuators(model: mujoco.MjModel) -> dict[str, int]:
    return {model.actuator(actuator).name: actuator for actuator in range(model.nu)}


def _pairs(old: Mapping[str, int], new: Mapping[str, int], renamed: Mapping[str, str]) -> Iterator[tuple[int, int]]:
    for name, number in old.items():
        body, slash, _ = name.partition("/")
        name = FREE_JOINT if slash and renamed.get(body) == HIP else renamed.get(name, name)
        if name in new:
            yield number, new[name]


def _copy(source: npt.NDArray[np.float64], start: int, target: npt.NDArray[np.float64], place: int, count: int) -> None:
    target[place : place + count] = source[start : start + count]
