"""Speed and growth of mimoc compared with MIMo 3 (`mimo_infant`), each in its own Python and MuJoCo.

    python benchmarks/mimo3.py PATH_TO_MIMO3 --python MIMO3_PYTHON [--hands mitten] [--pose sitting] [--rounds 7]
    python benchmarks/mimo3.py PATH_TO_MIMO3 --python MIMO3_PYTHON --growth

PATH_TO_MIMO3 is the folder with `mimo_infant` in a copy of https://github.com/trieschlab/MIMo; MIMO3_PYTHON is a Python
in which it runs, with its pinned packages (MuJoCo 3.3.0). Both infants are 18 months old with the joints of the chest
(46 or 90 motors), alone on a floor in the same posture, and get random commands for control steps of two physics steps
of 5 ms. Physics is `mujoco.mj_step` alone, of both bodies in MIMo 3's MuJoCo. An environment, each in its own MuJoCo,
observes proprioception and the vestibular sense, then touch on the whole body or both eyes as well, as each does by
default (but without acuity). Neither has wrappers. All alternate, and the median CPU time of an episode with its reset
counts. With `--growth`, both bodies are measured alike, all joints at zero, and compared with WHO's standards, mean of
the sexes.
"""

import argparse
import json
import os
import statistics
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

os.environ.setdefault("MUJOCO_GL", "egl")
os.environ["LP_NUM_THREADS"] = "0"

import gymnasium
import mujoco
import numpy as np
from beside import CONTROL_STEPS, ENVIRONMENTS, STEP_S, check_observations, random_commands
from beside_mimo import infant, senses_of
from measuring import felt

import mimoc
from mimoc.base.geometry.primitives import Solids, extents, girth
from mimoc.base.units import m_to_cm
from mimoc.bundle.model import PRIMITIVES
from mimoc.compiler.measuring import UP, compile_infant
from mimoc.studies.growth import Stature, compare_with_who, measure_compiled

FOLDER = Path(__file__).parent
AGES_MONTHS = (0, 1, 2, 4, 6, 9, 12, 18, 24)
Ask = Callable[..., Any]  # Sends a request to MIMo 3's side and returns its answer.


def main() -> None:
    """Print speed or growth of both."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mimo3", type=Path, help="folder with mimo_infant")
    parser.add_argument("--python", type=Path, required=True, help="Python in which MIMo 3 runs")
    parser.add_argument("--hands", choices=tuple(ENVIRONMENTS), default="mitten")
    parser.add_argument("--pose", choices=("sitting", "supine"), default="sitting")
    parser.add_argument("--pixels", type=int, default=64, help="width and height of an image")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--growth", action="store_true", help="compare growth with WHO's standards")
    options = parser.parse_args()
    if not (options.mimo3 / "mimo_infant" / "simulation" / "envs" / "dummy.py").is_file():
        parser.error(f"{options.mimo3} does not contain MIMo 3's code (mimo_infant/simulation/envs/dummy.py)")
    with other_side(options.mimo3, options.python) as ask:
        print("MIMo 3:", ", ".join(f"{name} {version}" for name, version in ask("versions").items()))
        print(f"mimoc:  MuJoCo {mujoco.__version__}, Gymnasium {gymnasium.__version__}, NumPy {np.__version__}")
        if options.growth:
            compare_growth(ask, options.hands)
        else:
            compare_speed(ask, options.hands, options.pose, options.pixels, options.rounds)


@contextmanager
def other_side(mimo3: Path, python: Path) -> Iterator[Ask]:
    """Start MIMo 3's side in its own Python, and end it."""
    command = [str(python), "-c", "import mimo3_worker; mimo3_worker.serve()"]
    settings = {**os.environ, "MIMO3": str(mimo3.resolve()), "PYTHONPATH": str(FOLDER)}
    errors = subprocess.DEVNULL if "MIMO3_SHOW" not in os.environ else None
    with subprocess.Popen(
        command, env=settings, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors, text=True
    ) as process:
        assert process.stdin
        assert process.stdout

        def ask(what: str, **arguments: Any) -> Any:
            print(json.dumps({"ask": what, **arguments}), file=process.stdin, flush=True)
            answer = process.stdout.readline() if process.stdout else ""
            if not answer:
                raise SystemExit(f"MIMo 3's side failed at {what!r}; set MIMO3_SHOW=1 to see why")
            return json.loads(answer)

        yield ask
        process.stdin.close()


def compare_speed(ask: Ask, hands: str, pose: str, pixels: int, rounds: int) -> None:
    """Measure both infants with all senses in turn, and print a row for each sense."""
    spec = infant(hands, pose, {}, chest_joint=True)
    episodes: dict[str, tuple[Callable[[], float], Callable[[], float]]] = {}
    sizes: dict[str, tuple[dict, dict]] = {}
    with TemporaryDirectory() as folder:
        scene = str(mimoc.write_bundle(mimoc.build(spec), Path(folder) / "infant") / "scene.xml")
        names = ("MIMo 3, bare", "mimoc, bare")
        both = [ask("physics", name=name, hands=hands, pose=pose, scene=scene, own=name == names[0]) for name in names]
        sizes["physics"] = both[0], both[1]
        theirs, ours = (partial(ask, "episode", name=name) for name in names)
        episodes["physics"] = theirs, ours
        for senses in [name for name in CONTROL_STEPS if name != "physics"]:
            theirs = ask("open", name=senses, hands=hands, pose=pose, senses=senses, pixels=pixels, scene=scene)
            ours, episode = opened(spec, senses, pixels)
            sizes[senses], episodes[senses] = (theirs, ours), (partial(ask, "episode", name=senses), episode)
        taken_s = {name: ([], []) for name in episodes}
        for _ in range(rounds + 1):
            for name, pair in episodes.items():
                for times, run in zip(taken_s[name], pair, strict=True):
                    times.append(run())
    print(f"{'':28}{'numbers':>16}{'contacts':>16}{'CPU ms/simulated s':>22}{'opening [s]':>24}")
    pairs = f"{'MIMo 3':>8}{'mimoc':>8}"
    print(f"{'hands':13}{'senses':15}{pairs * 2}{'MIMo 3':>11}{'mimoc':>11}{'ratio':>8}{pairs}")
    for name, steps in CONTROL_STEPS.items():
        theirs, ours = sizes[name]
        row = "".join(f"{size[key]:8}" for key in ("numbers", "contacts") for size in (theirs, ours))
        times_ms = [1e3 * statistics.median(times[1:]) / (steps * STEP_S) for times in taken_s[name]]
        making = "".join(f"{size['making_s']:8.2f}" for size in (theirs, ours) if "making_s" in size)
        print(f"{hands:13}{name:15}{row}{times_ms[0]:11.1f}{times_ms[1]:11.1f}{times_ms[0] / times_ms[1]:8.2f}{making}")


def opened(spec: mimoc.InfantSpec, senses: str, pixels: int) -> tuple[dict, Callable[[], float]]:
    """Return size and opening time of mimoc's environment, and what runs an episode and returns its CPU time."""
    start = time.process_time()
    env = mimoc.make(mimoc.build(spec.with_(senses=senses_of(senses, pixels)))).unwrapped
    making_s = time.process_time() - start
    commands = random_commands(CONTROL_STEPS[senses], env.model.nu)
    env.reset(seed=0)
    check_observations(env, senses)
    numbers = gymnasium.spaces.flatdim(env.observation_space)

    def episode() -> float:
        begun = time.process_time()
        felt(env, commands)
        return time.process_time() - begun

    return {"numbers": numbers, "contacts": env.data.ncon, "making_s": making_s}, episode


def compare_growth(ask: Ask, hands: str) -> None:
    """Print size, weight and their z-scores of both at several ages."""
    columns = ("length_cm", "weight_kg", "head_circumference_cm")
    print(f"{'months':>6}  {'body':18}" + "".join(f"{name:>24}" for name in columns))
    for age_months in AGES_MONTHS:
        average = mimoc.InfantSpec(mimoc=1, name="infant", age_months=age_months, body={"hands": hands})
        published = average.with_(development="published")
        bodies = {
            "MIMo 3": stature(ask("grown", age_months=age_months, hands=hands)),
            "mimoc": measure_compiled(compile_infant(average)),
            "mimoc, published": measure_compiled(compile_infant(published)),
        }
        for name, body in bodies.items():
            rows = {row.indicator: row for row in compare_with_who(age_months, body)}
            cells = (f"{body[column]:14.2f} (z {rows[column].z['mean']:+.2f})" for column in columns)
            print(f"{age_months:6}  {name:18}" + "".join(f"{cell:>24}" for cell in cells), flush=True)


def stature(grown: dict[str, Any]) -> Stature:
    """Return length, weight and girth of the head of MIMo 3's solids, as of mimoc's."""
    kinds = [PRIMITIVES[kind] for kind in grown["types"]]
    sizes_m = np.array(grown["sizes_m"])
    turns = np.array(grown["turns"]).reshape(-1, 3, 3)
    solids = Solids(extents(zip(kinds, sizes_m, strict=True)), np.array(grown["places_m"]), turns)
    low_m, high_m = solids.span(UP)
    girths_cm = {
        part: m_to_cm(girth(kinds[number], sizes_m[number]))
        for part in ("head", "left_uarm1")
        for number in [grown["names"].index(part)]
    }
    return Stature(
        length_cm=m_to_cm(high_m - low_m),
        weight_kg=grown["mass_kg"],
        head_circumference_cm=girths_cm["head"],
        arm_circumference_cm=girths_cm["left_uarm1"],
    )


if __name__ == "__main__":
    main()
