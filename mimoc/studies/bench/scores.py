"""What is entered for the benchmark, what it scores in one task at one age, and whole results with their tables."""

import html
import inspect
import json
import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from hashlib import sha256
from pathlib import Path

import numpy as np

from mimoc.base.classes import import_class
from mimoc.base.errors import BundleError, MovementError, PolicyError
from mimoc.base.rounding import render_json
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import LOCK, digests
from mimoc.bundle.regular_files import UnusableFileError, one_line, read_json_file, read_regular_file
from mimoc.compiler import building
from mimoc.motion.hand_movement import UNIT_M_S, Movement
from mimoc.movement.filming import Film
from mimoc.movement.measured import measure_movement
from mimoc.movement.sample import distance, real_infants
from mimoc.policies.class_policy import EXAMPLE, class_or_text, is_class
from mimoc.policies.named import policy_of
from mimoc.policies.policy import Policy, PolicyMaker, start_again
from mimoc.policies.spec import parse_policy
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.schema.base import Model
from mimoc.schema.quantities import Real, Whole
from mimoc.studies.bench.table import Cell, bench_table, chosen_cells
from mimoc.studies.notebook import table_rows

MAX_BYTES = 2**29  # Largest file of a policy that results name: 512 MB, as for any policy.


def text_for(text: str, cell: Cell) -> str:
    """Return the policy for a task and an age: `{task}` and `{age}` stand for theirs, as in `runs/{task}_{age}.zip`."""
    return text.replace("{task}", cell.task).replace("{age}", f"{cell.age_months:g}")


def bound_policy(env: InfantEnv, text: str) -> Policy:
    """Return a policy for an environment, by name or as `module:Class`; raise a MimocError if none fits this infant."""
    return policy_of(env, class_or_text(text), _load)


def digests_of(texts: Iterable[str]) -> dict[str, str]:
    """Return digests of trained policies, named files and folders, and modules of classes, by their paths as written.

    Those that ship with mimoc are known by its version. A text that is no policy raises a MimocError.
    """
    return digests({name: path.read_bytes() for text in dict.fromkeys(texts) for name, path in _files_of(text)})


def check_files(policy: str, texts: Iterable[str], recorded: Mapping[str, str]) -> None:
    """Check that the policy of a file of results has the files that it recorded, below the current folder.

    Anyone may have written that file. So nothing outside of the current folder is read, nothing that is not recorded,
    and no module is imported before it has been compared. Other files, or some elsewhere, are a PolicyError.
    """
    trust = "; if you trust it, name it yourself with --policy"
    contents = dict[str, bytes]()
    for text in dict.fromkeys(texts):
        module = text.partition(":")[0].removesuffix(".py") if is_class(text) else ""
        if "." in module:
            raise PolicyError(f"its policy '{policy}' is in a package, whose other modules are not recorded{trust}")
        named = [f"{module}.py"] if module else [part.argument for part in parse_policy(text)]
        for path in (Path(name).expanduser() for name in named if name):
            if os.path.lexists(path) and not path.resolve().is_relative_to(Path.cwd().resolve()):
                raise PolicyError(f"its policy '{policy}' reads {path}, outside of this folder{trust}")
        for name, path in [(f"{module}.py", Path(f"{module}.py"))] if module else _files_of(text):
            if name in recorded:
                contents[name] = _content(path)
            else:
                raise PolicyError(f"its policy '{policy}' reads {name}, which is not among the files that were scored")
    if digests(contents) != recorded:
        raise PolicyError(f"the files of its policy '{policy}' are not those that were scored")


def _content(path: Path) -> bytes:
    try:
        return read_regular_file(path, MAX_BYTES) or b""
    except UnusableFileError as error:
        raise PolicyError(f"{path}: {error}") from None


def _files_of(text: str) -> Iterator[tuple[str, Path]]:
    if is_class(text):
        path = Path(inspect.getfile(import_class(text, EXAMPLE)))
        yield path.name, path
        return
    for part in parse_policy(text):
        path = Path(part.argument or "").expanduser()
        if part.argument and path.is_file():
            yield part.argument, path
        elif part.argument and path.is_dir():
            yield from ((item.as_posix(), item) for item in sorted(path.rglob("*")) if item.is_file())


def _load(path: str) -> PolicyMaker:
    """Return the trained policy in a file; PyTorch is only imported when there is one."""
    from mimoc.training import load_policy

    return load_policy(path)


Z_95 = 1.959963984540054  # Quantile of the standard normal distribution for intervals of 95 %.
WINDOW_S = 2.0
"""Length of the parts of an episode of which each is one movement, since smoothness depends on how many there are."""
NO_GOAL = "free"  # The kind of task that nobody succeeds in.


class CellScores(Model):
    """The scores of a policy in one task at one age; what could not be measured is None."""

    bundle: str
    """Digest of the infant."""
    episodes: Whole
    successes: Whole | None
    """Episodes that succeeded; None for a task without a goal."""
    success: Real | None
    """Their share."""
    success_95: tuple[Real, Real] | None
    """Its interval of 95 % (Wilson)."""
    mean_return: Real
    """Mean over episodes of the sum of rewards."""
    returns: tuple[Real, ...]
    """Sum of rewards of each episode, in the order of the seeds, to compare policies in pairs."""
    effort: Real
    """Mean over control steps of the effort of the actuators."""
    arc_length: Real | None
    """Mean spectral arc length of hands and feet; larger is smoother."""
    jerk: Real | None
    """Mean log dimensionless jerk of hands and feet, with its sign turned; larger is smoother."""
    likeness: Real | None
    """Mean distance to real infants; those are .77 to 1.57 from each other."""
    states: str
    """Digest of all states of all episodes."""


def score_cell(cell: Cell, policy: str, episodes: int) -> CellScores:
    """Return the scores of a policy in the first test episodes; raise a MimocError if it does not fit, or fails."""
    bundle = building.build(cell.spec)
    states = sha256()
    successes = 0
    returns, efforts, movements, distances = list[float](), list[float](), list[Movement](), list[float]()
    with closing(InfantEnv(bundle)) as env:
        act = bound_policy(env, policy)
        for number in range(episodes):
            seed = bench_table().seeds.test[0] + number
            generator = np.random.default_rng(seed)
            seen = Film()
            paths_m = list[FloatArray]()
            observation, _ = env.reset(seed=seed)
            start_again(act)
            limbs = (*env.manifest.anatomy.arms, *env.manifest.anatomy.legs)
            ends = [env.model.body(limb.end).id for limb in limbs if limb.end]
            total, ended, success = 0.0, False, False
            while not ended:
                if cell.row.likeness:
                    seen.watch(env)
                observation, reward, terminated, truncated, info = env.step(act(generator, observation))
                total = total + float(reward)
                ended = terminated or truncated
                success = bool(info["is_success"])
                efforts.append(env.effort())
                states.update(env.data.qpos.tobytes() + env.data.qvel.tobytes())
                paths_m.append(env.data.xipos[ends].copy())
            returns.append(total)
            successes += success
            step_s = ms_to_s(env.manifest.step_ms)
            places_m = np.array(paths_m)
            for limb in range(len(ends)):
                movements += movements_in(places_m[:, limb], step_s)
            if cell.row.likeness:
                distances += _distance(seen)
        has_goal = env.manifest.task.kind != NO_GOAL
    count = len(returns)
    inside = digests({name: content for name, content in bundle.files.items() if name != LOCK})
    return CellScores(
        bundle=f"sha256:{sha256(json.dumps(inside).encode()).hexdigest()}",
        episodes=count,
        successes=successes if has_goal else None,
        success=successes / count if has_goal else None,
        success_95=wilson_interval(successes, count) if has_goal else None,
        mean_return=math.fsum(returns) / count,
        returns=tuple(returns),
        effort=math.fsum(efforts) / len(efforts),
        arc_length=_mean([one.arc_length for one in movements]),
        jerk=_mean([one.jerk for one in movements]),
        likeness=_mean(distances),
        states=f"sha256:{states.hexdigest()}",
    )


def wilson_interval(successes: int, count: int) -> tuple[float, float]:
    """Return the interval of 95 % of a share (Wilson 1927, J Am Stat Assoc 22: 209), within 0 and 1.

    (p + z² / 2n ± z √(p (1 - p) / n + z² / 4n²)) / (1 + z² / n), with p = successes / n and z = 1.96.
    """
    share, part = successes / count, Z_95**2 / count
    middle = share + part / 2
    half = Z_95 * math.sqrt(share * (1 - share) / count + part / (4 * count))
    low, high = ((middle + sign * half) / (1 + part) for sign in (-1, 1))
    return (0.0 if successes == 0 else low, 1.0 if successes == count else high)


def movements_in(path_m: FloatArray, step_s: float) -> list[Movement]:
    """Return the movements of a hand or a foot, of 2 s each; those slower than 5 cm/s throughout are left out.

    Its places after each control step of an episode have the shape (t, 3). What is left at the end is left out, but for
    an episode that is shorter than 2 s.
    """
    steps = round(WINDOW_S / step_s)
    whole = range(0, len(path_m) - steps, steps)
    parts = [path_m[start : start + steps + 1] for start in whole] or [path_m]
    movements = [Movement(part, step_s) for part in parts if len(part) > 1]
    return [one for one in movements if one.speed_m_s.max() > UNIT_M_S]


def _distance(film: Film) -> list[float]:
    try:
        return [distance(measure_movement(film.to_recording("episode").seen), real_infants())]
    except MovementError:
        return []


def _mean(values: Sequence[float]) -> float | None:
    """Return the mean of all that are numbers; None if there are none."""
    numbers = [value for value in values if math.isfinite(value)]
    return math.fsum(numbers) / len(numbers) if numbers else None


EXACT = {"states": "the states of the simulation, though not what is written of them"}
"""What a difference in a score is called, where its name does not say it."""


class BenchResults(Model):
    """What a policy scored in some tasks at some ages."""

    benchmark: str
    """Name of the benchmark, with its version."""
    policy: str
    """The policy, as it was named."""
    policy_files: Mapping[str, str]
    """Digests of the files that decide what it does."""
    seeds: tuple[Whole, Whole]
    """Seeds of the test episodes, the second excluded."""
    software: Mapping[str, str]
    """Versions of mimoc, MuJoCo, NumPy and Python, and the type of the machine."""
    cells: Mapping[str, CellScores]
    """The scores by task and age, such as `reach/9`."""

    @property
    def content(self) -> bytes:
        """The file: JSON with sorted keys and rounded numbers."""
        return render_json(self.model_dump(mode="json"), levels=3)

    @property
    def scored(self) -> Mapping[Cell, CellScores]:
        """The scores by cell, in the order of the benchmark."""
        return {cell: self.cells[cell.name] for cell in chosen_cells() if cell.name in self.cells}


def read_results(path: str | Path) -> BenchResults:
    """Read what a policy scored; raise a BundleError if the file is no such result, or of another benchmark."""
    path, version = Path(path).expanduser(), bench_table().benchmark
    try:
        results = read_json_file(path, BenchResults)
    except UnusableFileError as error:
        raise BundleError(f"{path}: not a result of `mimoc bench`: {error}") from None
    if results is None:
        raise BundleError(f"{path}: there is no such file; name what `mimoc bench -o FILE` wrote")
    if results.benchmark != version:
        raise BundleError(f"{path}: of {results.benchmark!r:.40}, but this mimoc has {version}; enter again")
    if unknown := results.cells.keys() - {cell.name for cell in chosen_cells()}:
        raise BundleError(f"{path}: {version} has no {min(unknown)!r:.40}; enter again")
    return results


def differences(before: CellScores, after: CellScores) -> list[str]:
    """Return how scores differ as they stand in files, a text each; nothing if they are the same to the bit."""
    pairs = {name: (getattr(before, name), getattr(after, name)) for name in CellScores.model_fields}
    written = {name: [render_json(value) for value in pair] for name, pair in pairs.items()}
    other = [name for name, (old, new) in written.items() if old != new]
    if other == ["states"]:
        return [EXACT["states"]]
    short = [name for name in other if name not in ("states", "returns")] or other
    return [f"{name} {_short(pairs[name][0])}, now {_short(pairs[name][1])}" for name in short]


def markdown_tables(entries: Sequence[BenchResults]) -> str:
    """Return two tables in Markdown: how often policies succeed in each task, and the other scores, as means."""
    policies = [_code(entry.policy) for entry in entries]
    rows = [("task", "months", *policies), ("---", *["---:"] * (1 + len(entries)))]
    for cell in chosen_cells():
        if any(cell.name in entry.cells for entry in entries):
            values = (_success(entry.cells.get(cell.name)) for entry in entries)
            rows.append((cell.task, f"{cell.age_months:g}", *values))
    rows.append(("**mean**", "", *(_number(_mean_of(entry, "success")) for entry in entries)))
    headings = ("policy", "cells", "success", "effort", "arc length", "jerk", "likeness")
    means = [headings, ("---", *["---:"] * (len(headings) - 1))]
    for policy, entry in zip(policies, entries, strict=True):
        scores = (_mean_of(entry, name) for name in ("success", "effort", "arc_length", "jerk", "likeness"))
        means.append((policy, f"{len(entry.cells)}", *map(_number, scores)))
    return f"{table_rows(rows)}\n\n{table_rows(means)}"


def _code(text: str) -> str:
    """Return text that anyone may have written as code in a cell of a table; nothing of it is Markdown or HTML."""
    if re.fullmatch(r"[\w +:(){}./,-]+", text, re.ASCII):
        return f"`{text}`"
    special = {ord(character): f"&#{ord(character)};" for character in "`|*_~\\["}
    return f"<code>{html.escape(one_line(text)).translate(special)}</code>"


def _success(scores: CellScores | None) -> str:
    if scores is None:
        return ""
    if scores.success is None or scores.success_95 is None:
        return f"distance {_number(scores.likeness)}"
    low, high = scores.success_95
    return f"{scores.success:.2f} ({low:.2f}-{high:.2f})"


def _mean_of(entry: BenchResults, name: str) -> float | None:
    values = [value for scores in entry.scored.values() if (value := getattr(scores, name)) is not None]
    return math.fsum(values) / len(values) if values else None


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _short(value: object) -> str:
    return f"{value:.9g}" if isinstance(value, float) else f"{value}"[:60]
