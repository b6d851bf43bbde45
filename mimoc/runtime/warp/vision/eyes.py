"""The cameras of all infants' eyes, drawn by MuJoCo Warp's ray caster."""

import copy
from collections.abc import Sequence

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

from mimoc.mujoco_layout import SOLIDS_GROUP
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.vision.textures import Textures
from mimoc.senses.sense import IntArray
from mimoc.senses.vision.eyes import HIDDEN_GROUP
from mimoc.senses.vision.spec import VisionEntry


class Eyes:
    """What the eyes of all infants see, without shadows and reflections, as on the CPU."""

    def __init__(self, models: Sequence[mujoco.MjModel], entry: VisionEntry, body_of_world: IntArray, model: mjw.Model):
        """Set aside room for the pictures, and put the textures on Warp's present device.

        Args:
            models: The different bodies.
            entry: Cameras and sizes, which are the same for all.
            body_of_world: Which of the bodies lives in each world.
            model: That of all worlds.
        """
        times, fovy_deg = entry.supersample, {float(fovy) for single in models for fovy in single.cam_fovy}
        self._context = mjw.create_render_context(
            _without(models[0], entry.unseen),
            len(body_of_world),
            cam_res=(times * entry.width_px, times * entry.height_px),
            cam_active=list(entry.cameras),
            render_rgb=True,
            render_depth=False,
            render_seg=False,
            render_skybox=True,
            use_precomputed_rays=len(fovy_deg) == 1,
        )
        self._model = copy.copy(model)  # Its arrays are those of the worlds, but for the materials' textures.
        self._use_textures(models, body_of_world)

    def __call__(self, data: mjw.Data) -> wp.array:
        """Return packed colours, 0xAARRGGBB, of the pixels of one eye after the other, shape (worlds, pixels)."""
        mjw.refit_bvh(self._model, data, self._context)
        mjw.render(self._model, data, self._context)
        return self._context.rgb_data

    def _use_textures(self, models: Sequence[mujoco.MjModel], body_of_world: IntArray) -> None:
        """Let each world have the textures of its own infant."""
        self._textures = Textures(models)
        skies = np.array(self._textures.skies)
        self._context.textures = wp.array(self._textures.registry, dtype=wp.Texture2D)
        self._context.textures_registry = self._textures.registry
        self._context.skybox_tex_id = put(skies[body_of_world], wp.int32)
        widths = [1 if sky < 0 else self._textures.registry[sky].width for sky in skies]
        self._context.skybox_face_width = put(np.array(widths)[body_of_world], wp.int32)
        if self._textures.registry:
            self._model.mat_texid = put(self._textures.of_materials(models)[body_of_world], wp.int32)


def _without(model: mujoco.MjModel, bodies: Sequence[str]) -> mujoco.MjModel:
    """Return a copy of a model in which some bodies are not drawn."""
    shown = copy.copy(model)
    shown.geom_group[shown.geom_group == SOLIDS_GROUP] = 0  # Its ray caster draws no skins.
    hidden = [model.body(body).id for body in bodies]
    shown.geom_group[np.isin(model.geom_bodyid, hidden)] = HIDDEN_GROUP
    return shown
