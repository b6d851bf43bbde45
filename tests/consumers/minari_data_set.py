"""Minari's loader and iterator, of what `mimoc export --to minari` wrote."""

import os
from pathlib import Path

import minari
import numpy as np


def use(bundles: Path) -> str:
    os.environ["MINARI_DATASETS_PATH"] = str(bundles / "recorded" / "minari")
    (name,) = minari.list_local_datasets()
    data_set = minari.load_dataset(name)
    episodes = list(data_set.iterate_episodes())
    assert [len(episode.rewards) for episode in episodes] == [data_set.total_steps // len(episodes)] * len(episodes)
    for episode in episodes:
        assert data_set.action_space.contains(episode.actions[0])
        assert all(np.isfinite(readings).all() for readings in episode.observations.values())
    return f"{len(episodes)} episodes, {data_set.total_steps} steps"
