"""A model of an infant at one age, from which those of other ages are cast without printing or parsing MJCF.

The ages of an infant differ in numbers only. MuJoCo's own compiler makes each model, from its own copy of the elements,
into which the numbers are written as they would be printed; what never changes, such as textures, is taken from the
first model. `compile_model` of a whole bundle gives the same, array for array, but for the name of the whole model:
that of the first infant stays.
"""

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.rounding import rounded_array
from mimoc.bundle.model import prepare
from mimoc.compiler.model_check import compile_model
from mimoc.compiler.model_parameters import Slot, parameters, read
from mimoc.mjcf.scene import SceneTree
from mimoc.mjcf.skin import Skin, single, texture_places

KINDS = ("body", "jnt", "dof", "geom", "site", "cam", "light", "tendon", "actuator", "eq", "key", "qpos", "bvh", "pair")
"""What the arrays of a model begin with whose numbers can depend on age."""
STATISTICS = ("meaninertia", "meanmass", "meansize", "extent", "center")


class DifferenceError(Exception):
    """Two scenes differ in more than numbers."""


@dataclass(frozen=True, slots=True)
class ModelInstance:
    """The model of a scene, of which copies can be had."""

    shared: mujoco.MjModel
    """What never changes, such as textures."""
    numbers: mujoco.MjModel
    """All else."""
    arrays: Sequence[str]
    """The names of the arrays with this."""
    skin: Skin | None
    """Its skin, which MuJoCo only copies."""

    def model(self) -> mujoco.MjModel:
        """Return a model of one's own, with the skin of the template."""
        model = copy.copy(self.shared)
        for name in self.arrays:
            getattr(model, name)[...] = getattr(self.numbers, name)
        for name in STATISTICS:
            setattr(model.stat, name, getattr(self.numbers.stat, name))
        prepare(model)
        return model

    def set_textures(self, model: mujoco.MjModel) -> None:
        """Write the skin of the scene into one of these models."""
        if self.skin:
            _set_textures(model, self.skin)


class ModelTemplate:
    """A scene whose numbers can be changed."""

    def __init__(self, files: Mapping[str, bytes], scene: SceneTree):
        """Keep a scene, and the model of the files that it was printed to.

        Raises:
            ModelError: If MuJoCo rejects it.
        """
        self._model, self._spec = compile_model(files), without_textures(files)
        self._numbers, self._rest = read(scene)
        self._slots = parameters(scene, self._spec)
        values = (getattr(*slot) for slot in self._slots)
        self._views = [value if isinstance(value, np.ndarray) else None for value in values]
        self._arrays = _same_arrays(self._model, self._spec.compile())
        self.broken = False
        """Whether MuJoCo has rejected a scene; it is of no use then."""

    def instantiate(self, scene: SceneTree) -> ModelInstance:
        """Return the model of a scene that differs from this one in numbers only; the next one is compared with it.

        Raises:
            DifferenceError: If more is different; nothing has changed then.
            ValueError: If MuJoCo rejects it; this template is broken then.
        """
        numbers, rest = read(scene)
        if rest != self._rest:
            raise DifferenceError
        every = zip(self._slots, self._views, numbers, self._numbers, strict=True)
        _write([(slot, view, now) for slot, view, now, before in every if now != before])
        self._numbers, self.broken = numbers, True
        instance = ModelInstance(self._model, self._spec.compile(), self._arrays, scene.skin)
        self.broken = False
        return instance


def without_textures(files: Mapping[str, bytes]) -> mujoco.MjSpec:
    """Return MuJoCo's elements of a scene; decoding textures and skins takes longer than all else."""
    meshes = {name: content for name, content in files.items() if name.startswith("assets/") and name[-4:] != ".png"}
    include = {name: files[name] for name in ("infant.xml",) if name in files}  # A world is in one file.
    spec = mujoco.MjSpec.from_string(files["scene.xml"].decode(), include=include, assets=meshes)
    for skin in list(spec.skins):
        spec.delete(skin)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for texture in list(spec.textures):
        spec.delete(texture)
    return spec


def model_without_pictures(files: Mapping[str, bytes]) -> mujoco.MjModel:
    """Return the model of a scene without textures and skins, in which contacts are as in the whole one."""
    return without_textures(files).compile()


def _set_textures(model: mujoco.MjModel, skin: Skin) -> None:
    """Write a skin into the model of an infant that has the same one at another age."""
    for layer in skin.layers:
        index = model.skin(layer.name).id
        first, bone = model.skin_vertadr[index], model.skin_boneadr[index]
        model.skin_vert[first : first + len(layer.verts_m)] = single(layer.verts_m)
        place = model.skin_texcoordadr[index]
        model.skin_texcoord[place : place + len(layer.texcoords)] = texture_places(layer)
        model.skin_bonebindpos[bone : bone + len(layer.bones)] = single(layer.origins_m)
        model.skin_bonebindquat[bone : bone + len(layer.bones)] = single(layer.quats)


def _same_arrays(model: mujoco.MjModel, without_textures: mujoco.MjModel) -> list[str]:
    """Return the names of the arrays whose numbers can depend on age."""
    names = [name for name in dir(model) if name.split("_")[0].rstrip("0") in KINDS or name.startswith("qpos")]
    arrays = [name for name in names if isinstance(getattr(model, name), np.ndarray) and getattr(model, name).size]
    return [name for name in arrays if np.array_equal(getattr(model, name), getattr(without_textures, name))]


def _write(changes: Sequence[tuple[Slot, npt.NDArray[Any] | None, Any]]) -> None:
    """Write numbers, as they are read from where they are printed, to where attributes begin."""
    several = [numbers if isinstance(numbers, tuple) else (numbers,) for *_, numbers in changes]
    printed = rounded_array(np.array([*chain(*several)], float))
    end = 0
    for ((element, attribute), view, numbers), values in zip(changes, several, strict=True):
        start, end = end, end + len(values)
        if view is not None:
            view[: len(values)] = printed[start:end]
        else:
            read = printed[start:end].tolist()
            setattr(element, attribute, read if isinstance(numbers, tuple) else read[0])
