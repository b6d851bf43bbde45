"""The shortest way to an environment: from a bundle or from a spec."""

from functools import partial
from pathlib import Path
from typing import Any

import gymnasium

from mimoc import runtime
from mimoc.bundle import Bundle
from mimoc.schema import InfantSpec


def make(source: Bundle | InfantSpec | str | Path, **options: Any) -> gymnasium.Env:
    """Return the environment of an infant, as `gymnasium.make("mimoc/Infant-v0", bundle=..., **options)` does.

    Made from a spec, it can be given another scene whenever it is reset: `reset(options={"scene_seed": 7})`.

    Args:
        source: A bundle, the folder of one, or a spec; a path that ends in .yaml or .yml is that of a spec.
        options: For the environment, and `max_episode_steps` for Gymnasium.

    Raises:
        SpecError: If a spec cannot be built.
        BundleError: If a folder is not a whole bundle.
        ModelError: If MuJoCo refuses the model.
        RenderingError: If the infant sees, and there is no OpenGL here.
    """
    is_spec_file = isinstance(source, (str, Path)) and Path(source).suffix in (".yaml", ".yml")
    if isinstance(source, Bundle) or not (is_spec_file or isinstance(source, InfantSpec)):
        return runtime.make(source, **options)
    from mimoc import pipeline  # The compiler, which bundles do without.

    builder = pipeline.builder(source if isinstance(source, InfantSpec) else pipeline.load_spec(source))
    scenes = partial(builder, check=False)
    return runtime.make(scenes(builder.spec.scene.seed), next_bundle=scenes, **options)
