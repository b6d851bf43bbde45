"""Cost of senses of the body that mature, in a control step, compared with the same senses as they are.

    python benchmarks/maturing_senses.py [--rounds 60]

All alternate, in turned order, and the lower quartile of wall time counts, as that is least changed by other load.
"""

import argparse
import time

import numpy as np

import mimoc

PLAIN = {"proprioception": {}, "vestibular": {}}
SENSES = {
    "touch as it is": {**PLAIN, "touch": {}},
    "canals": {**PLAIN, "vestibular": {"canals": "age"}, "touch": {}},
    "pain": {**PLAIN, "touch": {}, "pain": {}},
    "sa1, ra": {**PLAIN, "touch": {"channels": ["sa1", "ra"]}},
    "sa1, ra, pc, ct": {**PLAIN, "touch": {"channels": ["sa1", "ra", "pc", "ct"]}},
}
STEPS = 20


def main() -> None:
    """Print a row for each set of senses."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=60)
    rounds = parser.parse_args().rounds
    infant = {"mimoc": 1, "name": "infant", "age_months": 9, "delays": {"preset": "physiological"}}
    envs = {name: mimoc.make(mimoc.InfantSpec.model_validate({**infant, "senses": SENSES[name]})) for name in SENSES}
    commands = np.random.default_rng(0).uniform(-0.3, 0.3, (STEPS, *envs["pain"].action_space.shape))
    taken_us: dict[str, list[float]] = {name: [] for name in envs}
    for number in range(rounds):
        for name in list(envs)[:: 1 if number % 2 else -1]:
            envs[name].reset(seed=0)
            start = time.perf_counter()
            for command in commands.astype(np.float32):
                envs[name].step(command)
            taken_us[name].append(1e6 * (time.perf_counter() - start) / STEPS)
    usual = np.quantile(taken_us["touch as it is"], 0.25)
    for name, times in taken_us.items():
        lower = np.quantile(times, 0.25)
        print(f"{name:18}{lower:8.0f} us a control step, {lower / usual:.2f} of touch as it is")


if __name__ == "__main__":
    main()
