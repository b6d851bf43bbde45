"""What consumers read: default bundles with motors, muscles and all senses, and a recording in others' formats."""

import sys
from pathlib import Path

import mimoc

CONFIGS = Path(__file__).parents[2] / "configs"
NAMES = ("nine_months", "muscle", "all_senses")
FORMATS = ("minari", "lerobot")
EPISODES, STEPS = 2, 6


def prepare(folder: Path) -> Path:
    """Write all of it into a new folder, which is returned."""
    for name in NAMES:
        mimoc.write_bundle(mimoc.build(mimoc.load_spec(CONFIGS / f"{name}.yaml")), folder / name)
    with mimoc.Recorder(mimoc.make(folder / "all_senses"), folder / "recorded" / "mimoc") as env:
        env.action_space.seed(0)
        for seed in range(EPISODES):
            env.reset(seed=seed)
            for _ in range(STEPS):
                env.step(env.action_space.sample())
    recording = mimoc.read_recording(folder / "recorded" / "mimoc")
    for name in FORMATS:
        mimoc.export_recording(recording, name, folder / "recorded" / name)
    return folder


if __name__ == "__main__":
    prepare(Path(sys.argv[1]))
