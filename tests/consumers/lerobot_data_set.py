"""LeRobot's own loader, of what `mimoc export --to lerobot` wrote."""

from pathlib import Path

import numpy as np
import torch
from lerobot.datasets.lerobot_dataset import LeRobotDataset


def use(bundles: Path) -> str:
    data_set = LeRobotDataset("mimoc/recorded", root=bundles / "recorded" / "lerobot", video_backend="pyav")
    assert len(data_set) == data_set.meta.total_frames > 0
    assert data_set.meta.camera_keys
    for index in (0, len(data_set) - 1):
        frame = data_set[index]
        assert frame["index"] == index
        for name, feature in data_set.features.items():
            if name in data_set.meta.camera_keys:
                assert frame[name].shape[0] == 3
                assert 0 < frame[name].mean() < 1
            elif name in frame:
                assert np.asarray(frame[name]).size == np.prod(feature["shape"]), name
    batch = next(iter(torch.utils.data.DataLoader(data_set, batch_size=4)))
    assert len(batch["action"]) == 4
    return f"{data_set.meta.total_episodes} episodes, {len(data_set)} frames, {len(data_set.meta.camera_keys)} cameras"
