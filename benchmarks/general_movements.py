"""How much infants that move by themselves are like twelve real ones, and how they move at each age.

    python benchmarks/general_movements.py [--age 3] [--actuation muscle] [--hands mitten] [--seeds 0:12] [--real DIR]
    python benchmarks/general_movements.py --ages 0 1 2 3 4 6 9 12 [--actuation muscle] [--seeds 0:12]
    python benchmarks/general_movements.py --head-and-touch 0 1 2 3 [--actuation muscle] [--seeds 0:5]

The first prints the 21 measures of `docs/movement_measures.md` beside those of the real infants, the distance, and how
well windows of 8 s are told from those of real infants: from their aggregates, or exactly if the keypoints are in a
folder (`101.csv` ... `112.csv`, the 14 joints of MINI-RGBD, which are for research only). The second prints a column
for each age. The third prints how long the head is in the midline by the neck's angle as it is, and as the infant feels
it with the delays and noise of its age, and how often hands touch head and trunk in the first minute. An episode takes
two seconds, and five in the third.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import mimoc
from mimoc.motion.reading import read_points
from mimoc.movement.filming import Film, Filmed, film_policy
from mimoc.movement.report import measure_all
from mimoc.movement.sample import (
    accuracy_against_real,
    balanced_accuracy,
    distance,
    real_infants,
    standard_scores,
    windows_of,
)
from mimoc.policies.rollout import rollout
from mimoc.recording.measures import measure_recordings
from mimoc.schema.infant import InfantSpec

BY_AGE = (
    *("hand_speed_median_trunk_s", "foot_speed_median_trunk_s", "foot_speed_p95_trunk_s", "foot_moving_share"),
    *("hand_spread_trunk", "foot_spread_trunk", "foot_unit_s", "kicks_per_min", "kick_amplitude_trunk"),
    *("hip_excursion_deg", "knee_excursion_deg", "hip_knee_r", "hips_together_r", "kicks_together_share"),
    *("kick_foot_acceleration_m_s2", "foot_path_dimension", "dimensions", "hand_to_face_share", "feet_apart_trunk"),
    *("head_midline_share", "head_aside_deg", "head_turning_deg_s"),
)


def main() -> None:
    """Print what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--age", type=float, default=3.0)
    parser.add_argument("--ages", type=float, nargs="*", default=())
    parser.add_argument("--actuation", choices=("muscle", "torque", "position"), default="muscle")
    parser.add_argument("--hands", choices=("mitten", "five_finger"), default="mitten")
    parser.add_argument("--seeds", default="0:12")
    parser.add_argument("--policy", default="general_movements")
    parser.add_argument("--head-and-touch", type=float, nargs="*", default=())
    parser.add_argument("--real", type=Path)
    options = parser.parse_args()
    seeds = range(*map(int, options.seeds.split(":")))

    def films(age_months: float) -> list[Filmed]:
        spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "scene": {"kind": "flat", "pose": "supine"}}
        spec |= {"actuation": {"model": options.actuation}, "body": {"hands": options.hands}}
        return [*film_policy(InfantSpec.model_validate(spec), options.policy, seeds)]

    if options.head_and_touch:
        print_head_and_touch(options.head_and_touch, options.actuation, seeds)
    elif options.ages:
        print_ages(options.ages, [films(age) for age in options.ages])
    else:
        print_beside_real(films(options.age), options.real)


def print_beside_real(films: Sequence[Filmed], folder: Path | None) -> None:
    """Print what is known of real infants, and means over seeds beside it, first of the 21 measures."""
    sample, measured = real_infants(), measure_all(films)
    means = measured.means
    print(f"{'measure':32} {'real infants':>16} {'simulated':>16} {'z':>6}")
    for name, score in standard_scores(means, sample).items():
        deviation = np.std([measures[name] for measures in measured.infants if name in measures], ddof=1)
        real = f"{sample.means[name]:.3g} ± {sample.deviations[name]:.2g}"
        print(f"{name:32} {real:>16} {f'{means[name]:.3g} ± {deviation:.2g}':>16} {score:6.2f}")
    distances = sorted(distance(measures, sample) for measures in measured.infants)
    print(f"distance of the means over seeds: {distance(means, sample):.2f}")
    print(f"distances of the seeds: median {np.median(distances):.2f}, {distances[0]:.2f} to {distances[-1]:.2f}")
    windows = windows_of([film.seen for film in films])
    about, spread = accuracy_against_real(windows, np.random.default_rng(0))
    print(f"told from infants drawn from the real ones' aggregates: {about:.2f} ± {spread:.2f}")
    if folder:
        real = windows_of([read_points(path, rate_hz=30) for path in sorted(folder.glob("1[01][0-9].csv"))])
        print(f"told from the real infants: {balanced_accuracy(real, windows):.3f}")


def print_ages(ages_months: Sequence[float], films: Sequence[Sequence[Filmed]]) -> None:
    """Print means over seeds, a column for each age."""
    columns = [measure_all(some).means for some in films]
    print(f"{'measure':32}" + "".join(f"{age:9g}" for age in ages_months))
    for name in BY_AGE:
        print(f"{name:32}" + "".join(f"{column.get(name, float('nan')):9.2f}" for column in columns))


TOUCHES = (
    *("hands_to_head_per_min", "hands_to_trunk_per_min", "hands_self_touch_share"),
    *("gaze_midline_share", "gaze_turning_deg_s"),
)
FELT = {
    "senses": {"proprioception": {}},
    "delays": {"preset": "physiological"},
    "noise": {"motor": "maturing", "proprioception_deg": "age"},
}
"""What a spec has besides where infants feel their neck with the delays and noise of their age."""


def print_head_and_touch(ages_months: Sequence[float], actuation: str, seeds: Sequence[int]) -> None:
    """Print what infants do in a minute, mean and standard deviation over seeds, a row for each age."""
    names = (HEAD, f"{HEAD}, felt late", *TOUCHES)
    print(f"| months | {' | '.join(names)} |", flush=True)
    for age_months in ages_months:
        spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "scene": {"kind": "flat", "pose": "supine"}}
        spec |= {"actuation": {"model": actuation}}
        plain, felt = (InfantSpec.model_validate(keys) for keys in (spec, spec | FELT))
        rows = [recorded_minute(plain, seed) for seed in seeds]
        late = [measure_all([film]).means[HEAD] for film in film_policy(felt, "general_movements", seeds)]
        columns = [[row[HEAD] for row in rows], late, *([row[name] for row in rows] for name in TOUCHES)]
        cells = (f"{np.mean(column):.2f} ± {np.std(column, ddof=1):.2f}" for column in columns)
        print(f"| {age_months:g} | {' | '.join(cells)} |", flush=True)


HEAD = "head_midline_share"


def recorded_minute(infant: InfantSpec, seed: int) -> dict[str, float]:
    """Return the measures of head, gaze and touch of a minute of general movements, by its recording and its film."""
    film = Film()
    with TemporaryDirectory() as folder:
        kept = Path(folder) / "minute"
        env = mimoc.Recorder(mimoc.make(infant), kept, movement=("keypoints", "gaze", "contacts"))
        for _ in rollout(env, "general_movements", steps=6000, seed=seed):
            film.watch(env.unwrapped)
        env.close()
        table = measure_recordings(kept, TOUCHES)
    return {**measure_all([film.to_recording("infant")]).means, **{name: table[name][0] for name in TOUCHES}}


if __name__ == "__main__":
    main()
