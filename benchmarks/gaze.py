"""How eyes move by age, beside what was measured in infants: the tables of docs/behaviours.md.

    python benchmarks/gaze.py [saccades] [steps] [latency] [pursuit] [reflexes] [head] [vergence] [around] [--seeds 5]

Infants lie on their backs with the head held, with physiological delays and `processing: age`; where the head turns,
the hip is held, or they sit in a seat that holds the chest.
Means over seeds, with the standard deviation behind ±. Which numbers were put in stands in the docs.
"""

import argparse
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

import mimoc
from mimoc.compiler.presets import SACCADE_MS
from mimoc.policies.rollout import Run

SACCADE_DEG_S = 30.0  # A saccade lasts as long as the eye is faster.
PUBLISHED_PEAK = {5: 213, 15: 352, 30: 455}
PURSUIT = {2: {3: 0.50, 6: 0.25, 12: 0.11}, 3: {}, 5: {3: 0.9, 6: 0.9, 12: 0.9}}
LATENCY = {4: "595 ± 30", 8: "442 ± 13"}


class Trial:
    """An infant that looks at a ball, which is moved at will."""

    def __init__(self, age_months: float, seed: int, step_ms: float = 10, held: bool = True, seated: bool = False):
        spec: dict[str, Any] = {"mimoc": 1, "name": "child", "age_months": age_months}
        spec |= {"senses": {"vestibular": {}}, "control": {"step_ms": step_ms}}
        spec |= {"delays": {"preset": "physiological", "processing": "age"}}
        ball = {"name": "ball", "radius_cm": 1, "mass_g": 5, "at": {"x_cm": 200, "y_cm": 200}}
        parts = ["chest"] if seated else ["hip", "head"] if held else ["hip"]
        scene = {"kind": "flat", "pose": "sitting" if seated else "supine", "held": parts, "objects": [ball]}
        self.env = mimoc.make(mimoc.InfantSpec.model_validate(spec | {"scene": scene})).unwrapped
        self.env.reset(seed=seed)
        model, data = self.env.model, self.env.data
        cameras = [model.camera(eye.camera).id for eye in self.env.manifest.anatomy.eyes]
        self._cameras = cameras
        self.eyes_m = data.cam_xpos[cameras].mean(axis=0).copy()
        self._axes = data.body("head").xmat.reshape(3, 3).copy()
        joint = int(model.body("object_ball").jntadr[0])
        self._ball, self._ball_speed = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self.place(0.0)
        mujoco.mj_forward(model, data)
        self.run = Run(self.env, "look_at(ball)", seed=seed)
        self.place(0.0)
        self.look = self.run.policies[""]._ensemble.behaviours[0]
        self.step_s = step_ms / 1000
        eyes = [f"robot:{side}_eye_horizontal" for side in ("left", "right")]
        self._angles = [model.joint(eye).qposadr[0] for eye in eyes]
        self._speeds = [model.joint(eye).dofadr[0] for eye in eyes]
        self._signs = np.array([1.0, -1.0])

    def place(self, left_deg: float, away_m: float = 1.0) -> None:
        """Put the ball somewhere to the left of straight ahead of the eyes, as they were at the start."""
        left = np.radians(left_deg)
        direction = self._axes @ np.array([np.cos(left), np.sin(left), 0.0])
        self.env.data.qpos[self._ball : self._ball + 3] = self.eyes_m + away_m * direction
        self.env.data.qvel[self._ball_speed : self._ball_speed + 6] = 0.0

    def steps(self, seconds: float, left_deg: Callable[[float], float]) -> np.ndarray:
        """Return angle [deg] and speed [deg/s] of the eyes after each control step, of the ball's place by time."""
        rows = list[tuple[float, float]]()
        for step in range(round(seconds / self.step_s)):
            self.place(left_deg(step * self.step_s))
            self.run.step()
            data = self.env.data
            eyes = (self._signs * np.degrees([data.qpos[self._angles], data.qvel[self._speeds]])).mean(axis=1)
            rows.append((float(eyes[0]), float(eyes[1])))
        return np.array(rows)

    def gaze_deg(self) -> float:
        """Return how far to the left the eyes look, in the frame of the head at the start."""
        lines = self._axes.T @ -self.env.data.cam_xmat[self._cameras].reshape(-1, 3, 3)[:, :, 2].mean(axis=0)
        return float(np.degrees(np.arctan2(lines[1], lines[0])))

    def head_deg(self) -> float:
        """Return how far the head is turned to the left, from where it was at the start."""
        ahead = self._axes.T @ self.env.data.body("head").xmat.reshape(3, 3)[:, 0]
        return float(np.degrees(np.arctan2(ahead[1], ahead[0])))


@contextmanager
def trial(*arguments: Any, **keys: Any) -> Iterator[Trial]:
    """Open a trial, and close its infant."""
    opened = Trial(*arguments, **keys)
    try:
        yield opened
    finally:
        opened.env.close()


def saccades_in(rows: np.ndarray) -> list[tuple[int, int]]:
    """Return the steps from and until which an eye is faster than `SACCADE_DEG_S`."""
    is_fast = np.abs(np.concatenate([[0.0], rows[:, 1], [0.0]])) > SACCADE_DEG_S
    turns = np.flatnonzero(np.diff(is_fast.astype(int)))
    return [(int(begin), int(end)) for begin, end in turns.reshape(-1, 2)]


def shown(values: Any, form: str = "{:.0f}") -> str:
    """Return mean and standard deviation in words."""
    values = np.array([value for value in values if value is not None and np.isfinite(value)])
    if not len(values):
        return "none"
    return f"{form.format(values.mean())} ± {form.format(values.std())}"


def saccades(seeds: int) -> None:
    """Print the main sequence: saccades that go all the way, which the young else do in steps."""
    print("| months | control step | size | peak, °/s | published | duration, ms | 21 + 2.2 x size |")
    for age in (1, 4, 12):
        for step_ms in (10, 20) if age == 4 else (10,):
            for size_deg in (5, 15, 30):
                peaks, lasts_ms = list[float](), list[float]()
                for seed in range(seeds):
                    with trial(age, seed, step_ms) as it:
                        it.look._law = replace(it.look._law, first_step=1.0)
                        it.steps(1.5, lambda time_s: 0.0)
                        rows = it.steps(2.0, lambda time_s, size_deg=size_deg: size_deg)
                        begin, end = saccades_in(rows)[0]
                        peaks.append(float(np.abs(rows[begin:end, 1]).max()))
                        lasts_ms.append(step_ms * (end - begin))
                print(
                    f"| {age} | {step_ms} ms | {size_deg}° | {shown(peaks)} | {PUBLISHED_PEAK[size_deg]} | "
                    f"{shown(lasts_ms)} | {21 + 2.2 * size_deg:.0f} |",
                    flush=True,
                )


def steps(seeds: int) -> None:
    """Print in how many steps the gaze comes to a target at 30 degrees."""
    print("| months | saccades to 30° | size of the first | of the second |")
    for age in (0, 1, 2, 3, 4, 12):
        counts, firsts, seconds = list[float](), list[float](), list[float]()
        for seed in range(seeds):
            with trial(age, seed) as it:
                it.steps(1.5, lambda time_s: 0.0)
                rows = it.steps(4.0, lambda time_s: 30.0)
                found = [
                    abs(rows[min(end + 1, len(rows) - 1), 0] - rows[max(begin - 1, 0), 0])
                    for begin, end in saccades_in(rows)
                ]
                found = [size for size in found if size > 1.5]
                counts.append(len(found))
                firsts.append(found[0])
                seconds.append(found[1] if len(found) > 1 else np.nan)
        print(f"| {age} | {shown(counts, '{:.1f}')} | {shown(firsts)}° | {shown(seconds)}° |", flush=True)


def latency(seeds: int) -> None:
    """Print the latency of saccades to a ball that is followed and turns up elsewhere, and to a new one."""
    print("| months | to a new target, ms | table | after a turn, ms | published |")
    for age in (1, 2, 4, 8, 12):
        first_ms, turn_ms = list[float](), list[float]()
        for seed in range(seeds):
            with trial(age, seed) as it:
                it.place(12.0)
                rows = it.steps(3.0, lambda time_s: 12.0)
                first_ms.append(1000 * it.step_s * saccades_in(rows)[0][0])
                own = list[float]()
                for jump in range(12):
                    rows = it.steps(2.5, lambda time_s, jump=jump: -12.0 if jump % 2 == 0 else 12.0)
                    if found := saccades_in(rows):
                        own.append(1000 * it.step_s * found[0][0])
                turn_ms.append(float(np.mean(own)))
        table = np.interp(age, list(SACCADE_MS), list(SACCADE_MS.values()))
        print(f"| {age} | {shown(first_ms)} | {table:.0f} | {shown(turn_ms)} | {LATENCY.get(age, '')} |", flush=True)


def pursuit(seeds: int) -> None:
    """Print speed of the eye by that of an even target, between saccades."""
    print("| months | target, °/s | smooth gain | published | saccades in 3 s | error of the gaze |")
    for age in (2, 3, 5, 12):
        for speed in (3, 6, 12):
            gains, counts, errors = list[float](), list[float](), list[float]()
            for seed in range(seeds):
                with trial(age, seed) as it:
                    start = -1.5 * speed
                    it.steps(2.5, lambda time_s, start=start: start)
                    rows = it.steps(3.0, lambda time_s, start=start, speed=speed: start + speed * time_s)
                    later = rows[round(1.0 / it.step_s) :]
                    is_smooth = np.ones(len(later), bool)
                    for begin, end in saccades_in(later):
                        is_smooth[max(begin - 3, 0) : end + 8] = False
                    gains.append(float(later[is_smooth, 1].mean() / speed))
                    counts.append(len(saccades_in(rows)))
                    places = start + speed * it.step_s * np.arange(len(rows))
                    errors.append(float(np.median(np.abs(rows[:, 0] - places)[round(1.0 / it.step_s) :])))
            published = PURSUIT.get(age, {}).get(speed, "")
            print(
                f"| {age} | {speed} | {shown(gains, '{:.2f}')} | {published} | {shown(counts, '{:.1f}')} | "
                f"{shown(errors, '{:.1f}')}° |",
                flush=True,
            )


def reflexes(seeds: int) -> None:
    """Print how much of a turn of the head eyes make up for: in the dark, and by the field alone."""
    print("| months | vestibulo-ocular gain at .5 Hz, dark | published | optokinetic gain at .1 Hz |")
    for age in (1, 2, 4, 12):
        gains: dict[str, list[float]] = {"dark": [], "field": []}
        for seed in range(seeds):
            for kind, rate_hz in (("dark", 0.5), ("field", 0.1)):
                with trial(age, seed, held=False) as it:
                    changes = {"optokinetic_gain": 0.0} if kind == "dark" else {"vestibular_gain": 0.0}
                    it.look._law = replace(it.look._law, **changes)
                    it.look._known = lambda time_s: 0
                    gains[kind].append(turned_gain(it, rate_hz))
        published = "1.03 ± .01" if age <= 4 else ""
        dark, field = (shown(gains[kind], "{:.2f}") for kind in ("dark", "field"))
        print(f"| {age} | {dark} | {published} | {field} |", flush=True)


def turned_gain(it: Trial, rate_hz: float) -> float:
    """Return how far eyes turn against a head that a torque turns to and fro, by how far that turns."""
    model, data = it.env.model, it.env.data
    joint = model.joint("robot:head_swivel")
    torque_nm = 2.0 * float(joint.stiffness[0])
    heads, eyes, velocity = list[float](), list[float](), np.empty(6)
    for step in range(round(3.0 / rate_hz / it.step_s)):
        data.qfrc_applied[joint.dofadr[0]] = torque_nm * np.sin(2 * np.pi * rate_hz * step * it.step_s)
        it.place(0.0)
        it.run.step()
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, it.look._head, velocity, 1)
        heads.append(float(velocity[2]))
        eyes.append(float((it._signs * data.qvel[it._speeds]).mean()))
    later = slice(len(heads) // 3, None)
    head, eye = np.array(heads)[later], np.array(eyes)[later]
    return -float(head @ eye / (head @ head))


def head(seeds: int) -> None:
    """Print how far the head turns to a target at 30 degrees, and how much later than the eyes."""
    print("| months | gaze after 3 s | head after 3 s | head after the eyes, ms |")
    for age in (1, 2, 3, 6, 12):
        gazes, heads, lates_ms = list[float](), list[float](), list[float]()
        for seed in range(seeds):
            with trial(age, seed, seated=True) as it:
                it.steps(1.5, lambda time_s: 0.0)
                start, eye_s, head_s = it.head_deg(), None, None
                for step in range(300):
                    it.place(30.0)
                    it.run.step()
                    eye = abs(float((it._signs * np.degrees(it.env.data.qvel[it._speeds])).mean()))
                    if eye_s is None and eye > SACCADE_DEG_S:
                        eye_s = step * it.step_s
                    if head_s is None and it.head_deg() - start > 2.0:
                        head_s = step * it.step_s
                gazes.append(it.gaze_deg())
                heads.append(it.head_deg() - start)
                lates_ms.append(1000 * (head_s - eye_s) if head_s and eye_s else np.nan)
        print(f"| {age} | {shown(gazes)}° | {shown(heads)}° | {shown(lates_ms)} |", flush=True)


def vergence(seeds: int) -> None:
    """Print how far eyes converge on a ball 25 cm away, by how far they would have to."""
    print("| months | vergence / needed |")
    for age in (0, 1, 2, 4, 12):
        shares = list[float]()
        for seed in range(seeds):
            with trial(age, seed) as it:
                for _ in range(300):
                    it.place(0.0, 0.25)
                    it.run.step()
                data = it.env.data
                lines = -data.cam_xmat[it._cameras].reshape(-1, 3, 3)[:, :, 2]
                away = data.body("object_ball").xpos - data.cam_xpos[it._cameras]
                away /= np.linalg.norm(away, axis=1, keepdims=True)
                shares.append(float(np.arccos(lines[0] @ lines[1]) / np.arccos(away[0] @ away[1])))
        print(f"| {age} | {shown(shares, '{:.2f}')} |", flush=True)


def around(seeds: int) -> None:
    """Print what infants look at by themselves: an adult, two toys, and a room."""
    print("| months | things looked at in a minute | saccades |")
    for age in (0, 1, 4, 9):
        rates, jumps = list[float](), list[float]()
        for seed in range(seeds):
            vision = {"width_px": 64, "height_px": 64, "colour": "age", "contrast": "age", "field": "age"}
            spec: Any = {"mimoc": 1, "name": "child", "age_months": age, "senses": {"vision": vision}}
            spec["delays"] = {"preset": "physiological", "processing": "age"}
            adult = {"place": "in_front", "distance_cm": 40}
            spec["scene"] = {"kind": "room", "pose": "supine", "held": ["hip"], "seed": seed, "toys": {"count": [2, 2]}}
            spec["scene"]["caregiver"] = adult
            env = mimoc.make(mimoc.InfantSpec.model_validate(spec)).unwrapped
            run = Run(env, "look_around", seed=seed)
            look = run.policies[""]._ensemble.behaviours[0]
            for _ in range(1000):
                run.step()
            rates.append(run.summary().metrics["fixations_per_min"])
            jumps.append(6.0 * look._next.saccades)
            env.close()
        print(f"| {age} | {shown(rates)} | {shown(jumps)} |", flush=True)


TABLES: Mapping[str, Callable[[int], None]] = {
    "saccades": saccades,
    "steps": steps,
    "latency": latency,
    "pursuit": pursuit,
    "reflexes": reflexes,
    "head": head,
    "vergence": vergence,
    "around": around,
}


def main() -> None:
    """Print the tables that are asked for, or all."""
    parser = argparse.ArgumentParser(description="How eyes move by age.")
    parser.add_argument("tables", nargs="*", choices=[[], *TABLES], default=[])
    parser.add_argument("--seeds", type=int, default=5)
    given = parser.parse_args()
    for name in given.tables or TABLES:
        print(f"\n{name}", flush=True)
        TABLES[name](given.seeds)


if __name__ == "__main__":
    main()
