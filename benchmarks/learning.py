"""Learning to reach: performance of trained policies compared with a random policy, over several seeds.

    python benchmarks/learning.py [-o docs/learning] [--steps 200000] [--seeds 3] [--episodes 200]

Trains `configs/reach.yaml` with PPO, each seed in a folder of its own under `runs/learning`, where an interrupted
training goes on; then every trained infant, and one under a random policy, reaches for the same balls.
"""

import argparse
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean, median

import mimoc
from mimoc.bundle.files import write_file
from mimoc.cli.console import progress
from mimoc.render.plots import encode, learning_sheet
from mimoc.runtime.quantities import EpisodeResult
from mimoc.studies.notebook import markdown_table, open_notebook
from mimoc.training import Curve

CONFIG = "configs/reach.yaml"
RUNS = Path("runs/learning")
FIRST_BALL = 1000  # Seed of the first ball, which is not the seed of any training run.

ABOUT = """\
The average child of 18 months, held upright, learns with PPO to touch a ball with its right hand (`{config}`),
for {steps:,} control steps of 10 ms with each of {seeds} seeds. The trained policies and a random policy then reach for
the same {episodes} balls.

![Learning curves: mean and range of the seeds](learning.png)

{table}

Training took {minutes:.1f} minutes on one core, on average. `learning.csv` has the curves, one row for every 4,096
steps; the first rows are slightly too good, as episodes that a checkpoint interrupts are not counted."""


@dataclass(frozen=True, slots=True)
class Result:
    """The performance of a policy."""

    name: str
    episodes: list[EpisodeResult]

    def row(self) -> tuple[str, ...]:
        """Return its row of the table."""
        times_s = [each.duration_s for each in self.episodes if each.success]
        return (
            self.name,
            f"{fmean(each.success for each in self.episodes):.1%}",
            f"{fmean(times_s):.3f}" if times_s else "-",
            f"{median(times_s):.3f}" if times_s else "-",
            f"{fmean(each.total_reward for each in self.episodes):.1f}",
        )


def main() -> None:
    """Train, compare, and write a report with the learning curves."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", default="docs/learning")
    parser.add_argument("--steps", type=int, default=200_000)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--episodes", type=int, default=200)
    given = parser.parse_args()
    bundle = mimoc.build(mimoc.load_spec(CONFIG))
    curves, results = [], [Result("random policy", evaluated(bundle, "random", given.episodes))]
    for seed, training in trained(bundle, given.steps, given.seeds):
        curves.append(training.curve)
        policy = mimoc.load_policy(training.policy)
        results.append(Result(f"PPO, seed {seed}", evaluated(bundle, policy, given.episodes)))
    table = markdown_table(
        ("policy", "balls touched", "time to touch, mean [s]", "median [s]", "return, mean"),
        [result.row() for result in results],
    )
    print(table)
    write(given, curves, results[0], table)


def trained(bundle: mimoc.Bundle, steps: int, seeds: int) -> Iterator[tuple[int, mimoc.training.Training]]:
    for seed in range(seeds):
        with progress(f"training, seed {seed}") as show:
            yield seed, mimoc.train(bundle, RUNS / f"seed_{seed}", steps=steps, seed=seed, progress=show)


def evaluated(bundle: mimoc.Bundle, policy, episodes: int) -> list[EpisodeResult]:
    with closing(mimoc.InfantEnv(bundle)) as env:
        return mimoc.evaluate(env, policy, episodes, seed=FIRST_BALL)


def write(given: argparse.Namespace, curves: Sequence[Curve], random: Result, table: str) -> None:
    notebook = open_notebook("learning", given.out, quick=False)
    rows = [
        (seed, row.steps, row.episodes, row.success_rate, row.time_to_success_s, row.episode_return)
        for seed, curve in enumerate(curves)
        for row in curve.rows
    ]
    heading = "seed,steps,episodes,success_rate,time_to_success_s,episode_return"
    notebook.write_table("learning.csv", heading, rows)
    baseline = {
        "time_to_success_s": fmean(each.duration_s for each in random.episodes if each.success),
        "success_rate": fmean(each.success for each in random.episodes),
        "episode_return": fmean(each.total_reward for each in random.episodes),
        "episode_steps": fmean(each.steps for each in random.episodes),
    }
    columns = [curve.columns() for curve in curves]
    write_file(notebook.folder / "learning.png", encode(learning_sheet({"PPO": columns}, baseline)))
    about = ABOUT.format(
        config=CONFIG,
        steps=given.steps,
        seeds=given.seeds,
        episodes=given.episodes,
        table=table,
        minutes=fmean(curve.rows[-1].wall_s for curve in curves) / 60,
    )
    made = f"    python benchmarks/learning.py --steps {given.steps} --seeds {given.seeds} --episodes {given.episodes}"
    write_file(
        notebook.folder / "learning.md", f"# Learning to reach\n\n{about}\n\n## Reproduction\n\n{made}\n".encode()
    )


if __name__ == "__main__":
    main()
