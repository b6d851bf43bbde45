"""The benchmark that others enter: fixed infants, tasks and seeds, and what policies score in them.

What is finished outlives an interruption, and results can be scored again.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from pathlib import Path

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import MimocError, OutputError, PolicyError
from mimoc.bundle.files import check_place, make_folder, write_file
from mimoc.compiler import building
from mimoc.recording.folder import versions
from mimoc.runtime.env import InfantEnv
from mimoc.studies.bench.scores import (
    BenchResults,
    CellScores,
    bound_policy,
    check_files,
    differences,
    digests_of,
    read_results,
    score_cell,
    text_for,
)
from mimoc.studies.bench.table import Cell, bench_table, chosen_cells
from mimoc.studies.jobs import JobStore, Progress, run_jobs

LIBRARIES = ("mujoco", "numpy")
Job = tuple[Cell, str, int]  # A cell, the policy for it, and how many episodes there are.


@takes("the name of a policy", str)
def run_bench(
    policy: str,
    out: str | Path,
    tasks: Sequence[str] | None = None,
    ages_months: Sequence[float] | None = None,
    episodes: int | None = None,
    processes: int = 1,
    progress: Progress = lambda done, total: None,
) -> BenchResults:
    """Enter a policy for the benchmark, and write what it scored; the same call goes on after an interruption.

    Args:
        policy: All that `mimoc run --policy` takes, or a class as `module:Class`; `{task}` and `{age}` in it stand for
            those of each infant, as in `runs/{task}_{age}/policy.zip`.
        out: File to write: JSON, with sorted keys and rounded numbers.
        tasks: Names of tasks; all if left out.
        ages_months: Ages, of which each task is done at those that it has; all if left out.
        episodes: Number of episodes of each task at each age; by default as the benchmark says, and with any other
            number the result is a trial run, and not comparable.
        processes: Number of processes. With more than one, a script must guard its main part by
            `if __name__ == "__main__"`.
        progress: Called with the number of episodes done and their total.

    Raises:
        UnknownNameError: If there is no such task or policy.
        PolicyError: If the policy does not fit an infant, or fails; nothing is written then.
        OutputError: If the file cannot be written.

    Example:
        >>> import mimoc
        >>> results = mimoc.run_bench("zero", "zero.json", tasks=["stand"], ages_months=[11], episodes=2)
        >>> results.cells["stand/11"].success
        0.0
    """
    out = checked_file(out)
    jobs = [(cell, text_for(policy, cell), episodes or cell.episodes) for cell in chosen_cells(tasks, ages_months)]
    files = digests_of(text for _, text, _ in jobs)
    store = JobStore(out.parent, f"{out.name}.cells", CellScores)
    keys = [(cell.file_name, text, number, files, cell.spec_text) for cell, text, number in jobs]
    finished = _counter(jobs, progress)

    def score(places: Sequence[int]) -> Iterator[tuple[int, CellScores]]:
        waiting = [jobs[place] for place in places]
        _check(waiting)
        return run_jobs(score_cell, waiting, processes)

    results = store.complete(keys, score, finished)
    table = bench_table()
    entry = BenchResults(
        benchmark=table.benchmark,
        policy=policy,
        policy_files=files,
        seeds=table.seeds.test,
        software=versions(LIBRARIES),
        cells={cell.name: scores for (cell, _, _), scores in zip(jobs, results, strict=True)},
    )
    write_file(out, entry.content)
    store.clear()
    return entry


@takes("the path of results", *PATH)
def verify_bench(
    path: str | Path,
    tasks: Sequence[str] | None = None,
    ages_months: Sequence[float] | None = None,
    processes: int = 1,
    progress: Progress = lambda done, total: None,
    policy: str | None = None,
) -> Mapping[str, list[str]]:
    """Score a result again; return what differs in each cell: nothing where it is the same to the bit.

    Args:
        path: File that `run_bench` wrote; the policy must be where it was, below the current folder.
        tasks: Names of the tasks to score again; all in the file if left out.
        ages_months: Ages to score again; all in the file if left out.
        processes: See `run_bench`.
        progress: See `run_bench`.
        policy: The policy as it was named, if it is trusted to be elsewhere: outside of the current folder, nothing is
            read or imported that only the file names.

    Raises:
        BundleError: If the file is no result of this benchmark.
        PolicyError: If the policy is another one by now, elsewhere, or fails.

    Example:
        >>> import mimoc
        >>> _ = mimoc.run_bench("zero", "zero.json", tasks=["stand"], ages_months=[11], episodes=2)
        >>> mimoc.verify_bench("zero.json")
        {'stand/11': []}
    """
    results = read_results(path)
    every = {cell: text_for(results.policy, cell) for cell in results.scored}
    if policy is None:
        try:
            check_files(results.policy, every.values(), results.policy_files)
        except MimocError as error:
            raise PolicyError(f"{path}: {error}") from None
    elif policy != results.policy or digests_of(every.values()) != results.policy_files:
        raise PolicyError(f"{path}: '{policy}' is not the policy that was scored, or its files have changed")
    chosen = [cell for cell in chosen_cells(tasks, ages_months) if cell in every]
    if not chosen:
        raise MimocError(f"{path}: has no scores of these tasks and ages; leave out --tasks and --ages")
    jobs = [(cell, every[cell], results.cells[cell.name].episodes) for cell in chosen]
    finished = _counter(jobs, progress)
    compared = dict[str, list[str]]()
    for place, scores in run_jobs(score_cell, jobs, processes):
        name = chosen[place].name
        compared[name] = differences(results.cells[name], scores)
        finished(place)
    return {cell.name: compared[cell.name] for cell in chosen}


def write_specs(
    folder: str | Path, tasks: Sequence[str] | None = None, ages_months: Sequence[float] | None = None
) -> list[Path]:
    """Write the specs of the benchmark's infants, to train for them: `reach_9.yaml` and so on; return their paths."""
    folder = Path(folder).expanduser()
    cells = chosen_cells(tasks, ages_months)
    make_folder(folder, below=folder.parent)
    return [write_file(folder / f"{cell.file_name}.yaml", cell.spec_text.encode()) for cell in cells]


def checked_file(out: str | Path) -> Path:
    """Return the path of results to write, or raise an OutputError if they cannot be written there."""
    path = Path(out).expanduser()
    if path.suffix != ".json":
        raise OutputError(f"{path}: results are JSON; end the name in .json")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: there is no folder {path.parent}; make it, or choose another place")
    check_place(path)
    return path


def _check(jobs: Sequence[Job]) -> None:
    """Check that policies fit their infants, before anything takes time or is written; raise a PolicyError if not."""
    for cell, text, _ in jobs:
        with closing(InfantEnv(building.build(cell.spec))) as env:
            env.reset(seed=bench_table().seeds.test[0])
            try:
                bound_policy(env, text)
            except MimocError as error:
                raise PolicyError(f"{cell.name}: {error}") from None


def _counter(jobs: Sequence[Job], progress: Progress) -> Callable[[int], None]:
    """Return a function that counts the episodes of the job at a place as done."""
    total, done = sum(episodes for _, _, episodes in jobs), 0

    def finished(place: int) -> None:
        nonlocal done
        done += jobs[place][2]
        progress(done, total)

    return finished
