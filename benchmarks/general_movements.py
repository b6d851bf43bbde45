"""How much infants that move by themselves are like twelve real ones, and how they move at each age.

    python benchmarks/general_movements.py [--age 3] [--actuation muscle] [--hands mitten] [--seeds 0:12] [--real DIR]
    python benchmarks/general_movements.py --ages 0 1 2 3 4 6 9 12 [--actuation muscle] [--seeds 0:12]

The first prints the 21 measures of `docs/movement_measures.md` beside those of the real infants, the distance, and how
well windows of 8 s are told from those of real infants: from their aggregates, or exactly if the keypoints are in a
folder (`101.csv` ... `112.csv`, the 14 joints of MINI-RGBD, which are for research only). The second prints a column
for each age. An episode takes two seconds.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mimoc.motion.reading import read_points
from mimoc.movement.filming import Filmed, film_policy
from mimoc.movement.report import measure_all
from mimoc.movement.sample import (
    accuracy_against_real,
    balanced_accuracy,
    distance,
    real_infants,
    standard_scores,
    windows_of,
)
from mimoc.schema.infant import InfantSpec

BY_AGE = (
    *("hand_speed_median_trunk_s", "foot_speed_median_trunk_s", "foot_speed_p95_trunk_s", "foot_moving_share"),
    *("hand_spread_trunk", "foot_spread_trunk", "foot_unit_s", "kicks_per_min", "kick_amplitude_trunk"),
    *("hip_excursion_deg", "knee_excursion_deg", "hip_knee_r", "hips_together_r", "kicks_together_share"),
    *("kick_foot_acceleration_m_s2", "foot_path_dimension", "dimensions", "hand_to_face_share", "feet_apart_trunk"),
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
    parser.add_argument("--real", type=Path)
    options = parser.parse_args()
    seeds = range(*map(int, options.seeds.split(":")))

    def films(age_months: float) -> list[Filmed]:
        spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "scene": {"kind": "flat", "pose": "supine"}}
        spec |= {"actuation": {"model": options.actuation}, "body": {"hands": options.hands}}
        return [*film_policy(InfantSpec.model_validate(spec), options.policy, seeds)]

    if options.ages:
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


if __name__ == "__main__":
    main()
