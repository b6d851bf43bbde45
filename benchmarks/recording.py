"""Cost of recording: CPU time of control steps with and without it, and the size of what is recorded.

    python benchmarks/recording.py [--steps 4000] [--eyes]

Two environments of the same infant take the same steps in turn, 250 each, one of them recorded; the CPU time of the
thread that writes counts. With `--eyes`, a run of 2,000 steps
with all senses is recorded, measured, and replayed.
"""

import argparse
import tempfile
import time
from pathlib import Path
from statistics import median

import numpy as np

import mimoc
from mimoc.recording.recorder import EnvRecorder

CONFIG = Path(__file__).parents[1] / "configs" / "all_senses.yaml"
TURN = 250  # Control steps of an environment before it is the other's turn.


def main() -> None:
    """Print ratios and sizes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=4000)
    parser.add_argument("--eyes", action="store_true")
    options = parser.parse_args()
    spec = mimoc.load_spec(CONFIG).with_(senses={"vision": None})
    for name, each in {"with touch": spec, "without touch": spec.with_(senses={"touch": None})}.items():
        compare(name, each, options.steps, episode=options.steps)
        compare(f"{name}, episodes of {TURN} steps", each, options.steps, episode=TURN)
    if options.eyes:
        all_senses()


def compare(name: str, spec: mimoc.InfantSpec, steps: int, episode: int) -> None:
    """Print how much longer control steps take that are recorded."""
    with tempfile.TemporaryDirectory() as folder:
        plain = mimoc.make(spec)
        recorded = mimoc.Recorder(mimoc.make(spec), Path(folder) / "recording")
        spent: dict[str, list[float]] = {"plain": [], "recorded": []}
        for env in (plain, recorded):
            env.reset(seed=0)
        for done in range(0, steps, TURN):
            for which, env in (("plain", plain), ("recorded", recorded))[:: 1 if done // TURN % 2 else -1]:
                spent[which].append(turn(env, done, done + TURN < steps and (done + TURN) % episode == 0))
        start = time.process_time()
        recorded.close()
        ended_s = time.process_time() - start
        plain.close()
        whole = sum(spent["recorded"]) + ended_s
        turns = median(ours / theirs for ours, theirs in zip(spent["recorded"], spent["plain"], strict=True))
        size_mb = size_of(Path(folder)) / 1e6
        print(
            f"{name}: recorded / plain {whole / sum(spent['plain']):.3f} in all, {turns:.3f} in the median turn;"
            f" {1e6 * sum(spent['plain']) / steps:.0f} us a step; {size_mb:.2f} MB for {steps} steps",
            flush=True,
        )


def turn(env: mimoc.InfantEnv, done: int, is_end: bool) -> float:
    """Return the CPU time of some control steps, with all that is written of them."""
    actions = np.random.default_rng(done).uniform(-1, 1, (TURN, *env.action_space.shape)).astype(np.float32)
    start = time.process_time()
    for action in actions:
        env.step(action)
    if is_end:
        env.reset()
    if isinstance(env, EnvRecorder):
        env.recording.wait()
    return time.process_time() - start


def all_senses() -> None:
    """Print the size of a run with all senses, and whether it comes out again."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "recording"
        with mimoc.Recorder(mimoc.make(CONFIG), path) as env:
            env.reset(seed=0)
            for action in np.random.default_rng(0).uniform(-1, 1, (2000, *env.action_space.shape)):
                env.step(action.astype(np.float32))
        sizes_mb = [size_of(each) / 1e6 for each in (path, path / "episodes")]
        print(f"2,000 steps with all senses: {sizes_mb[0]:.2f} MB, {sizes_mb[1]:.2f} without the bundle")
        for replayed in mimoc.replay_recording(path):
            print(replayed)


def size_of(folder: Path) -> int:
    """Return the bytes of all files in a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


if __name__ == "__main__":
    main()
