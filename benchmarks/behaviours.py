"""Behaviours by age, and a film of each: the table and the pictures of docs/behaviours.md.

    python benchmarks/behaviours.py [--ages 0 3 6 9 12 18] [--films docs/behaviours] [--only sit ...] [--delays]

Each is run for ten seconds by the average child of each age, without pushes. If a folder for films is given, they are
written instead of the table. With `--delays`, it is the table of reaches under physiological delays, by control step
(with `--only sit`, that of sitting).
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np

import mimoc
from mimoc.policies.rollout import Run

AGES = (0, 3, 6, 9, 12, 18)
STEPS = 1000
GAZE_DEG = 5.0  # Median error of the gaze up to which an infant looks at something (a choice).
ROWS = {
    "hold": ("hold", "sitting"),
    "sit": ("sit", "sitting"),
    "prone": ("prone", "prone"),
    "hands_and_knees": ("hands_and_knees", "prone"),
    "stand": ("stand", "standing"),
    "kick": ("kick", "supine"),
    "look_at": ("hold+look_at({beside})", "supine"),
    "reach_for": ("hold+reach_for({above},right)", "supine"),
}
"""By behaviour, the policy and the pose that it is run in."""
TOYS = {"source": "builtin", "count": [3, 3], "size_cm": [10, 14]}
FILMS = {
    "hold": (9, "sitting", "hold", 300),
    "sit": (6, "sitting", "sit", 300),
    "sit_3_months": (3, "sitting", "sit", 200),
    "prone": (4, "prone", "prone", 300),
    "hands_and_knees": (8, "prone", "hands_and_knees", 300),
    "stand": (12, "standing", "stand", 300),
    "kick": (3, "supine", "kick(rate_per_min=20)", 600),
    "look_at": (9, "sitting", "sit+look_at(toy)", 200),
    "reach_for": (9, "sitting", "sit+look_at(left_hand)+reach_for((0.17, 0.12, 0.32), left)", 300),
}
"""By film: age, pose, policy and steps."""


DELAYED_AGES, STEPS_MS = (4, 6, 9, 12, 18, 24), (5, 10, 20)
REACHES_S = 3.0


def opened(age_months, pose, step_ms=10, delays="none", **scene) -> Any:
    spec: Any = {"mimoc": 1, "name": "child", "age_months": age_months, "senses": {"proprioception": {}}}
    spec |= {"control": {"step_ms": step_ms}, "delays": {"preset": delays}}
    env = mimoc.make(mimoc.InfantSpec(**{**spec, "scene": {"kind": "flat", "pose": pose, **scene}})).unwrapped
    env.reset(seed=0)
    return env


def places(env):
    """Return places to look at and to reach for, which depend on where an infant lies and how long its arm is."""
    data = env.data
    shoulder, elbow, hand = (data.body(f"right_{part}").xpos for part in ("upper_arm", "lower_arm", "hand"))
    arm_m = np.linalg.norm(elbow - shoulder) + np.linalg.norm(hand - elbow)
    eyes = data.body("head").xpos
    above, beside = shoulder + np.array([0.0, 0.0, 0.7 * arm_m]), eyes + np.array([0.1, 0.2, 0.3])
    return {name: "({:.3f}, {:.3f}, {:.3f})".format(*place) for name, place in (("above", above), ("beside", beside))}


def cell(name, age_months):
    """Return what comes of a behaviour at an age, in a few words."""
    policy, pose = ROWS[name]
    env = opened(age_months, pose)
    run = Run(env, policy.format(**places(env)), seed=0)
    for _ in range(STEPS):
        run.step()
    metrics = run.summary().metrics
    if name == "look_at":
        error_deg = metrics["gaze_error_deg"]
        return f"{'yes' if error_deg < GAZE_DEG else 'no'}, {error_deg:.1f}°"
    if name == "reach_for":
        seconds, closest_m = metrics.get("reached_s"), metrics["hand_closest_m"]
        return f"yes, {seconds:.1f} s" if seconds is not None else f"no, {100 * closest_m:.0f} cm off"
    if name == "kick":
        return f"{metrics['kick_hip_deg']:.0f}°"
    return "yes" if metrics["held_share"] else f"no, {metrics['held_s']:.1f} s"


def delayed_cell(name, age_months, step_ms):
    """Return the same of an infant with physiological delays: for how long it holds, or how near its palm stays."""
    policy, pose = ROWS[name]
    env = opened(age_months, pose, step_ms, "physiological")
    target = places(env)
    run = Run(env, policy.format(**target), seed=0)
    seconds = REACHES_S if name == "reach_for" else 10.0
    for _ in range(round(1000 * seconds / step_ms)):
        run.step()
    if name == "reach_for":
        palm_m = env.data.body("right_hand").xipos
        return f"{1000 * np.linalg.norm(palm_m - np.fromstring(target['above'][1:-1], sep=',')):.1f} mm"
    metrics = run.summary().metrics
    return "yes" if metrics["held_share"] else f"no, {metrics['held_s']:.1f} s"


def main():
    parser = argparse.ArgumentParser(description="Behaviours by age, and a film of each.")
    parser.add_argument("--ages", type=float, nargs="+")
    parser.add_argument("--films", type=Path)
    parser.add_argument("--only", nargs="+", help="these behaviours or films alone")
    parser.add_argument("--delays", action="store_true", help="under physiological delays, by control step")
    given = parser.parse_args()
    ages = given.ages or (DELAYED_AGES if given.delays else AGES)
    if given.films:
        for name in given.only or FILMS:
            age_months, pose, policy, steps = FILMS[name]
            env = opened(age_months, pose, **({"toys": TOYS, "seed": 3} if "toy" in policy else {}))
            summary = mimoc.record(env, policy, given.films / f"{name}.gif", steps=steps, height_px=160, rate_hz=10)
            print(name, dict(summary.metrics), flush=True)
        return
    if given.delays:
        print(f"| behaviour | control step | {' | '.join(f'{age:g}' for age in ages)} |", flush=True)
        for name in given.only or ("reach_for",):
            for step_ms in STEPS_MS:
                cells = " | ".join(delayed_cell(name, age, step_ms) for age in ages)
                print(f"| `{name}` | {step_ms} ms | {cells} |", flush=True)
        return
    print(f"| behaviour | {' | '.join(f'{age:g}' for age in ages)} |", flush=True)
    for name in given.only or ROWS:
        print(f"| `{name}` | {' | '.join(cell(name, age) for age in ages)} |", flush=True)


if __name__ == "__main__":
    main()
