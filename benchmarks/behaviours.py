"""Behaviours by age, and a film of each: the table and the pictures of docs/behaviours.md.

    python benchmarks/behaviours.py [--ages 0 3 6 9 12 18] [--films docs/behaviours] [--only sit ...] [--delays]
    python benchmarks/behaviours.py --reaching [--ages 4 6 9 12] [--seeds 20]
    python benchmarks/behaviours.py --living
    python benchmarks/behaviours.py --senses [--only sit stand]

Each is run for ten seconds by the average child of each age, without pushes. If a folder for films is given, they are
written instead of the table. With `--delays`, it is the table of reaches under physiological delays, by control step
(with `--only sit`, that of sitting). With `--reaching`, it is that of reaches with the senses, delays and noise of each
age. With `--living`, it says how infants move in some postures, and whether they lose them by it.
With `--senses`, it says for how long they hold postures by their own senses, with delays and noise.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np

import mimoc
from mimoc.motion.hand_movement import movement_of
from mimoc.policies.behaviours.reaching import ARRIVED_M
from mimoc.policies.rollout import Run
from mimoc.studies.experiments.sensed_reaching import place_in_front

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
    "look_around": (9, "sitting", "sit+look_around", 400),
    "reach_for": (9, "sitting", "sit+look_at(left_hand)+reach_for((0.17, 0.12, 0.32), left)", 300),
}
"""By film: age, pose, policy and steps."""


DELAYED_AGES, STEPS_MS = (4, 6, 9, 12, 18, 24), (5, 10, 20)
REACHES_S = 3.0


REACHING_AGES, REACHING_S = (4, 6, 9, 12), 4.0
REACHING_FILMS = {"reaching_4_months": 4, "reaching_12_months": 12}  # Age by film.
FILMED_SEED, FILMED_STEPS = 9, 250
NERVOUS = {
    "senses": {"proprioception": {"include": ["velocity"]}, "vestibular": {}, "touch": {}},
    "delays": {"preset": "physiological"},
    "noise": {"motor": "maturing", "proprioception_deg": "age", "vestibular_thresholds": "age"},
}
"""An infant with its own senses, their delays and noise, and those of its commands."""
REAL = {
    "arrived": {},
    "movement units": {4: "4-7", 6: "3", 9: "2", 12: "1-2"},
    "path / straight line": {4: "2-2.5", 6: "1.5-1.8", 9: "1.3-1.5", 12: "1.3-1.5"},
    "duration [s]": {4: "1-2", 9: ".7-1.2", 12: ".7-1.2"},
    "mean speed [m/s]": dict.fromkeys(REACHING_AGES, ".15-.4"),
    "peak speed [m/s]": dict.fromkeys(REACHING_AGES, ".3-.8"),
}
"""What is known of infants, by measure and age in months: docs/behaviours.md says from whom."""


def opened(age_months, pose, step_ms=10, delays="none", sees=False, **scene) -> Any:
    spec: Any = {"mimoc": 1, "name": "child", "age_months": age_months, "senses": {"proprioception": {}}}
    if sees:
        spec["senses"]["vision"] = {"width_px": 64, "height_px": 64}
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
    policy = policy.replace(",right)", ",right,truth)")  # The simple law, to see what delays cost the controller.
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


def drawn_reach(env, seed, words="right"):
    """Reset an infant; return the policy that reaches for a drawn place, and the place."""
    env.reset(seed=seed)
    place_m = place_in_front(env, np.random.default_rng(seed))
    return "hold+reach_for(({:.3f}, {:.3f}, {:.3f}), {})".format(*place_m, words), place_m


def reached(env, seed, words="right"):
    """Return the movement of a hand that reaches for a drawn place, until it arrives; None if it does not."""
    policy, place_m = drawn_reach(env, seed, words)
    run = Run(env, policy, seed=seed)
    hand, step_s = env.data.body("right_hand"), env.manifest.step_ms / 1000
    path_m = [hand.xipos.copy()]
    while len(path_m) <= REACHING_S / step_s:
        run.step()
        path_m.append(hand.xipos.copy())
        if np.linalg.norm(path_m[-1] - place_m) < ARRIVED_M:
            return movement_of(np.array(path_m), step_s)
    return None


def reaching_rows(ages, seeds, words="right"):
    """Yield the name of each measure and its cell at each age: median and quartiles of the reaches that arrived."""
    movements = {age: [reached(seated(age), seed, words) for seed in range(seeds)] for age in ages}
    arrived = {age: [movement for movement in movements[age] if movement] for age in ages}
    yield "arrived", [f"{len(arrived[age]) / seeds:.0%}" for age in ages]
    measures = (
        lambda movement: movement.units,
        lambda movement: movement.path_ratio,
        lambda movement: movement.duration_s,
        lambda movement: movement.speed_m_s.mean(),
        lambda movement: movement.speed_m_s.max(),
    )
    for name, measure in zip([*REAL][1:], measures, strict=True):
        quartiles = [np.percentile([measure(each) for each in arrived[age]] or [np.nan], (25, 50, 75)) for age in ages]
        yield name, [f"{middle:.2g} ({low:.2g}-{high:.2g})" for low, middle, high in quartiles]


def seated(age_months):
    """Return an infant in a seat that holds its trunk, with its own senses, delays and noise."""
    spec: Any = {"mimoc": 1, "name": "child", "age_months": age_months, **NERVOUS}
    return mimoc.make(mimoc.InfantSpec(**{**spec, "scene": {"pose": "sitting", "held": ["chest"]}})).unwrapped


LIVING = {"sit": (6, 9, 12), "stand": (9, 12, 15), "prone": (3, 6)}  # Ages at which postures are looked at.
LIVING_SEEDS = 5


def lived(posture, age_months, words, seed):
    """Return what becomes of a posture in ten seconds: for how long it is held, and how hand and head move in it."""
    env = opened(age_months, ROWS[posture][1])
    run = Run(env, f"{posture}({words})" if words else posture, seed=seed)
    hand, swivel = env.data.body("left_hand"), env.data.joint("robot:head_swivel")
    places_m, turns_deg = list[np.ndarray](), list[float]()
    for _ in range(STEPS):
        run.step()
        places_m.append(hand.xipos.copy())
        turns_deg.append(float(np.degrees(swivel.qpos[0])))
    speeds_m_s = np.linalg.norm(np.diff(places_m, axis=0), axis=1) / (env.manifest.step_ms / 1000)
    return run.summary().metrics["held_s"], 1000 * np.median(speeds_m_s), np.std(turns_deg)


def print_living():
    """Print for each posture and age how often it is held for ten seconds, still and moving, and how infants move."""
    print("| posture | months | held, still | held, moving | hand, median [mm/s] | head, SD [°] |", flush=True)
    for posture, ages in LIVING.items():
        for age in ages:
            still, moving = (
                np.array([lived(posture, age, words, seed) for seed in range(1, LIVING_SEEDS + 1)])
                for words in ("still", "")
            )
            held = [f"{np.sum(rows[:, 0] >= 10.0 - 1e-6):.0f} of {LIVING_SEEDS}" for rows in (still, moving)]
            hand, head = (f"{moving[:, at].mean():.1f} ± {moving[:, at].std(ddof=1):.1f}" for at in (1, 2))
            print(f"| `{posture}` | {age} | {' | '.join(held)} | {hand} | {head} |", flush=True)


SENSED: dict[str, tuple[float, ...]] = {"sit": (5, 6, 7, 9, 12), "stand": (11, 12, 13, 15, 18, 24)}
SENSED_SEEDS = 5
PROPRIOCEPTION_DEG = (0.5, 0.75, "age")


def sensed(posture, age_months, proprioception_deg, seed):
    """Return for how long a posture is held, [s], and the sway of the centre of mass after a second, RMS [mm]."""
    spec = mimoc.InfantSpec(
        mimoc=1,
        name="senses",
        age_months=age_months,
        senses={"proprioception": {}, "vestibular": {}},
        delays={"preset": "physiological"},
        noise={"motor": "maturing", "vestibular_thresholds": "age", "proprioception_deg": proprioception_deg},
        scene={"kind": "flat"},
    )
    env = mimoc.make(spec)
    run = Run(env, posture, seed=seed)
    hip = env.unwrapped.model.body("hip").id
    places_m = []
    held_s = 0.0
    while len(places_m) < STEPS and held_s > 0.01 * len(places_m) - 1e-6:
        run.step()
        places_m.append(env.unwrapped.data.subtree_com[hip][:2].copy())
        held_s = run.summary().metrics["held_s"]
    swaying_m = np.array(places_m[100:])
    return held_s, 1000.0 * np.sqrt(swaying_m.var(axis=0).sum()) if len(swaying_m) > 100 else np.nan


def print_sensed(postures):
    """Print for each posture, age and noise of proprioception how many infants hold it for ten seconds, and sway."""
    print("| posture | months | proprioception, ° | held | held, s | sway, mm |", flush=True)
    for posture in postures:
        for age in SENSED[posture]:
            for deg in PROPRIOCEPTION_DEG:
                rows = np.array([sensed(posture, age, deg, seed) for seed in range(1, SENSED_SEEDS + 1)])
                held = rows[:, 0] >= 10.0 - 0.02
                sway = rows[held, 1]
                told = f"{sway.mean():.1f} ± {sway.std():.1f}" if held.any() else ""
                share = f"{held.sum()} of {SENSED_SEEDS}"
                print(f"| `{posture}` | {age:g} | {deg} | {share} | {rows[:, 0].mean():.1f} | {told} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description="Behaviours by age, and a film of each.")
    parser.add_argument("--ages", type=float, nargs="+")
    parser.add_argument("--films", type=Path)
    parser.add_argument("--only", nargs="+", help="these behaviours or films alone")
    parser.add_argument("--delays", action="store_true", help="under physiological delays, by control step")
    parser.add_argument("--reaching", action="store_true", help="with the senses, delays and noise of each age")
    parser.add_argument("--seeds", type=int, default=20, help="reaches at each age")
    parser.add_argument("--living", action="store_true", help="how postures move, and whether they are lost by it")
    parser.add_argument("--senses", action="store_true", help="how postures are held by the infant's own senses")
    given = parser.parse_args()
    if given.senses:
        print_sensed(given.only or SENSED)
        return
    if given.living:
        print_living()
        return
    if given.reaching:
        ages = given.ages or REACHING_AGES
        print(f"| months | {' | '.join(f'{age:g}' for age in ages)} |", flush=True)
        for name, cells in reaching_rows(ages, given.seeds):
            print(f"| {name} | {' | '.join(cells)} |", flush=True)
            if REAL[name]:
                print(f"| infants | {' | '.join(REAL[name].get(age, '') for age in ages)} |", flush=True)
        for name, cells in reaching_rows(ages, given.seeds, "right, truth"):
            print(f"| {name}, `truth` | {' | '.join(cells)} |", flush=True)
        return
    ages = given.ages or (DELAYED_AGES if given.delays else AGES)
    if given.films:
        for name in given.only or (*FILMS, *REACHING_FILMS):
            seed = FILMED_SEED if name in REACHING_FILMS else 0
            if name in REACHING_FILMS:
                env, steps = seated(REACHING_FILMS[name]), FILMED_STEPS
                policy, _ = drawn_reach(env, seed)
            else:
                age_months, pose, policy, steps = FILMS[name]
                sees = "look_around" in policy
                toys = {"toys": TOYS, "seed": 3} if "toy" in policy or sees else {}
                env = opened(age_months, pose, sees=sees, **toys)
            file = given.films / f"{name}.gif"
            summary = mimoc.record(env, policy, file, steps=steps, height_px=160, rate_hz=10, seed=seed)
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
