"""Scenes as users of MIMo have them: a file that includes MIMo's tree and all else of it, with objects of their own.

The infant is mimoc's, built for MIMo, so that it has MIMo's names and its sizes are known.
"""

import re
import xml.etree.ElementTree as ElementTree
from copy import deepcopy
from pathlib import Path
from typing import Any

from PIL import Image
from support.store import made_once

import mimoc
from mimoc.schema import InfantSpec

FREE = '<freejoint name="mimo_location"/>'
WORLD = """
    <geom name="floor" type="plane" size="0 0 .25" material="matplane"/>
    <light mode="targetbodycom" target="upper_body" pos="0 0 5"/>
    <camera name="corner" pos="3 -3 3" mode="targetbody" target="mimo_location"/>
    <body name="ball" pos=".4 .1 .05">
      <freejoint/>
      <geom name="ball" type="sphere" size=".04" mass=".05" class="bouncy"/>
    </body>"""
SCENE = """<!-- A scene of somebody's -- with two hyphens, which MuJoCo reads. -->
<mujoco model="nursery">
  <option timestep="{timestep}" gravity="{gravity}" density="1.2"/>
  <default>
    <geom rgba=".5 .6 .7 1"/>
    <default class="bouncy"><geom solref="-20000 -20"/></default>
  </default>
  <asset>
    <texture name="texplane" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".1 .15 .2" width="64" height="64"/>
    <material name="matplane" texture="texplane" texrepeat="4 4"/>
    {assets}
  </asset>
  <include file="mimo/meta.xml"/>
  {sections}
  <worldbody>
    {world}
    <body name="mimo_location" pos="{pos}" {turn}>
      {joint}
      <include file="mimo/model.xml"/>
    </body>
  </worldbody>
</mujoco>
"""


def mimo_of(age_months: float = 9, **sections: Any) -> ElementTree.Element:
    name = f"for mimo {age_months} {sorted(sections.items())}"
    return deepcopy(made_once(name, lambda: build_mimo(age_months, **sections)))


def build_mimo(age_months: float, **sections: Any) -> ElementTree.Element:
    spec = {"name": "mimo", "age_months": age_months, "development": "published", **sections}
    spec = {"mimoc": 1, "senses": {"proprioception": {}, "vestibular": {}}, **spec}
    return ElementTree.fromstring(mimoc.build(InfantSpec.model_validate(spec), "mimo").files["infant.xml"])


def write_scene(folder: Path, infant: ElementTree.Element | None = None, **parts: str) -> Path:
    """Write a scene with an infant; *parts* replace parts of `SCENE`. Return its path."""
    root = mimo_of() if infant is None else deepcopy(infant)
    (hip,) = root.findall(".//body[@name='hip']")
    meta, model = ElementTree.Element("mujoco"), ElementTree.Element("mujoco")
    meta.extend(section for section in root if section.tag not in ("worldbody", "option"))
    for texture in meta.iter("texture"):
        if texture.get("file"):
            texture.set("file", f"pictures/{texture.get('name')}.png")
            (folder / "pictures").mkdir(parents=True, exist_ok=True)
            size = (12, 8) if texture.get("gridsize") else (8, 8)
            Image.new("RGB", size).save(folder / texture.get("file"))
    model.append(hip)
    (folder / "mimo").mkdir(parents=True, exist_ok=True)
    (folder / "mimo" / "meta.xml").write_bytes(ElementTree.tostring(meta))
    (folder / "mimo" / "model.xml").write_bytes(ElementTree.tostring(model))
    usual = {"timestep": ".005", "gravity": "0 0 -9.81", "assets": "", "sections": "", "world": WORLD}
    usual |= {"pos": "0 0 .4", "turn": "", "joint": FREE}
    path = folder / "nursery.xml"
    path.write_text(SCENE.format(**{**usual, **parts}))
    return path


def body(infant: ElementTree.Element, name: str) -> ElementTree.Element:
    return next(part for part in infant.iter("body") if part.get("name") == name)


def remove(infant: ElementTree.Element, name: str) -> None:
    parents = {child: parent for parent in infant.iter() for child in parent}
    gone = body(infant, name)
    names = {part.get("name") for part in gone.iter() if part.get("name")}
    parents[gone].remove(gone)
    for section in infant.findall("actuator") + infant.findall("sensor") + infant.findall("contact"):
        for element in list(section):
            if names & {value for key, value in element.attrib.items() if key != "name"}:
                section.remove(element)


def with_prefixes(path: Path) -> None:
    """Give geoms the names of MIMo's later scenes: `geom:right_hand1`."""
    model = path.parent / "mimo" / "model.xml"
    model.write_text(re.sub(r'(<geom name=")(?=(?:left|right)_\w+[1-4]")(?!\w+_larm)', r"\1geom:", model.read_text()))
