"""Regard of a mobile and of the own hands: what infants of several ages, on their backs, have before their eyes."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.quantities import AGE, Quantity
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import in_subtrees, load_posed
from mimoc.compiler.building import build
from mimoc.compiler.looks.pictures import encode_palette_png
from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.eyes import HIDDEN_GROUP
from mimoc.components.senses.vision.run import bind, lens_of
from mimoc.motion.labels import SIDES
from mimoc.policies.rollout import Run
from mimoc.render.picture_files import Picture, tile_pictures
from mimoc.render.plots import Band, Dots, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.studies.comparison import interval
from mimoc.studies.experiment import Experiment, Results, TrialResult, child, grid, measures_table
from mimoc.studies.experiments.looking import WEIGHTS
from mimoc.studies.notebook import PAGES, table_rows

BoolArray = npt.NDArray[np.bool_]

BEYOND_M = 1e-6  # How far behind a surface of head or eyes a line of sight goes on.


@dataclass(frozen=True, slots=True)
class Thing:
    """Something that can be seen."""

    is_part: BoolArray  # Which bodies of the model are parts of it, shape (nbody,).
    geoms: IntArray  # Its geoms whose middles are looked for, shape (n,).


@dataclass(frozen=True, slots=True)
class Points:
    """The middles of the geoms of a thing that nothing hides from an eye, shape (p,), of both eyes together."""

    angles_deg: FloatArray  # From the line of sight of the eye.
    depths_m: FloatArray  # How far away they are along it.
    is_sharp: BoolArray  # Whether they are in focus.

    def within(self, angle_deg: float, *, sharp: bool = False) -> bool:
        """Return whether one of them is so near to a line of sight, and perhaps in focus as well."""
        near = self.angles_deg <= angle_deg
        return bool((near & self.is_sharp if sharp else near).any())


class Sight:
    """The lines of sight from an infant's eyes to things.

    A line goes from the camera of an eye to the middle of a geom. What it meets first counts, but for head and eyes,
    which infants do not see. Middles of geoms behind an eye are at more than 90 degrees.
    """

    def __init__(self, env: InfantEnv, entry: VisionEntry):
        """Look with the eyes of an infant, as mature as *entry* says; it needs no pictures."""
        self._env, model = env, env.model
        self._cameras = [model.camera(eye.camera).id for eye in env.manifest.anatomy.eyes]
        self._unseen = {model.body(name).id for name in entry.unseen}
        self._lens = lens_of(entry)
        self._geom = np.zeros(1, np.int32)

    def thing(self, body: str, geoms: Sequence[str] = ()) -> Thing:
        """Return a body with all that hangs on it, to be looked for at some of its geoms, or at all."""
        model = self._env.model
        is_part = in_subtrees(model, [model.body(body).id])
        named = [model.geom(name).id for name in geoms]
        return Thing(is_part, np.array(named or np.flatnonzero(is_part[model.geom_bodyid]), np.intp))

    def points(self, thing: Thing) -> Points:
        """Return what of a thing is seen now by either eye, wherever it looks."""
        data, rows = self._env.data, list[tuple[float, float]]()
        for camera in self._cameras:
            eye_m = data.cam_xpos[camera]
            ahead = -data.cam_xmat[camera].reshape(3, 3)[:, 2]
            for geom in thing.geoms:
                away_m = data.geom_xpos[geom] - eye_m
                body = self._met(camera, eye_m, away_m)
                if body >= 0 and thing.is_part[body]:
                    depth_m = float(away_m @ ahead)
                    rows.append((depth_m / float(np.linalg.norm(away_m)), depth_m))
        cosines, depths_m = np.array(rows).reshape(-1, 2).T
        blurred_deg = np.zeros(len(rows)) if self._lens is None else self._lens.disc_deg(depths_m)
        return Points(np.degrees(np.arccos(cosines.clip(-1, 1))), depths_m, blurred_deg == 0)

    def gaze_deg(self, place_m: FloatArray) -> float:
        """Return the angle between the line of sight and a place, shape (3,), of the eye that looks farther from it."""
        data, angles = self._env.data, list[float]()
        for camera in self._cameras:
            away_m = place_m - data.cam_xpos[camera]
            cosine = -data.cam_xmat[camera].reshape(3, 3)[:, 2] @ away_m / np.linalg.norm(away_m)
            angles.append(float(np.degrees(np.arccos(np.clip(cosine, -1, 1)))))
        return max(angles)

    def _met(self, camera: int, eye_m: FloatArray, away_m: FloatArray) -> int:
        """Return the body that a line from an eye meets first, beside what it never sees; -1 for none."""
        model, data, begin_m = self._env.model, self._env.data, eye_m
        towards = away_m / np.linalg.norm(away_m)
        while True:
            further = mujoco.mj_ray(model, data, begin_m, towards, None, 1, int(model.cam_bodyid[camera]), self._geom)
            if further < 0:
                return -1
            body = int(model.geom_bodyid[self._geom[0]])
            if body not in self._unseen:
                return body
            begin_m = begin_m + (further + BEYOND_M) * towards


Luminance = npt.NDArray[Any]

MONTHS: Sequence[float] = (0, 1, 2, 3, 4, 6)
MOBILE: Mapping[str, Any] = {  # The object of `configs/mobile.yaml`.
    "name": "mobile",
    "kind": "mobile",
    "above": "chest",
    "height_cm": 25,
    "tied_to": "right_foot",
}
VISION: Mapping[str, Any] = {"contrast": "age", "colour": "age", "field": "age", "focus": "age", "fovy_deg": 100}
"""Eyes that mature, with pictures that reach beyond what is noticed until five months."""
SIZE_PX = 160
POLICIES: Mapping[str, str] = {
    "moves": "general_movements",
    "sees": "look_around+general_movements",
    "looks": "look_at:mobile+general_movements",
}
LABELS: Mapping[str, str] = {"moves": "only moves", "sees": "looks around", "looks": "looks at the mobile"}
SEEING_PX: Mapping[str, int] = {"sees": 64}
"""Size of the pictures that an infant acts from, by condition; the others need none."""
WATCHED_S, PICTURED_S = 0.2, 2.0
"""How often lines of sight are followed, and how often the infant's pictures are compared."""
ON_DEG, ON_S = 8.0, 0.2
"""The gaze is on the mobile if both eyes have looked so near to its middle for so long: a choice, less than the 9 to 12
degrees at which it is from straight ahead at the start."""
NEAR_DEG = 15.0  # Hands so near to the line of sight are looked at by BabyBench's measure, at every age alike.
HEAD_CAMERA_MONTHS, HEAD_CAMERA_SHARE = (1.0, 3.0), 0.1
"""Share of the frames of head cameras that show hands (Jayaraman, Fausey & Smith 2015-16: from memory)."""
COLOURS = 96
SHARE = Quantity("share", "Share of the time", "%")
CONTRAST = Quantity("contrast", "Contrast of the mobile", "%")


@dataclass(frozen=True, slots=True)
class Case:
    """An infant of an age that does something for some time."""

    age_months: float
    condition: str
    seconds: float


class Pictures:
    """What an infant observes of an instant, with and without the mobile."""

    def __init__(self, bundle: Bundle):
        """Open the eyes of an infant; see `close`."""
        self._model, self.data = load_posed(bundle)
        vision = bundle.manifest.senses.vision
        assert vision is not None, "it sees"
        self.entry = vision
        self._vision = bind(vision, self._model, bundle)
        bodies = in_subtrees(self._model, [self._model.body(bundle.manifest.objects[0].body).id])
        self._geoms = np.flatnonzero(bodies[self._model.geom_bodyid])

    def place(self, qpos: FloatArray) -> None:
        """Take over the configuration of another simulation of the same infant, shape (nq,)."""
        self.data.qpos[:] = qpos
        mujoco.mj_fwdPosition(self._model, self.data)

    def drawn(self) -> Picture:
        """Return what the cameras draw, without an infant's eye in between, shape (eyes, height, width, 3)."""
        return self._vision.eyes(self.data)

    def observed(self) -> Picture:
        """Return what the infant observes."""
        return self._vision(self.data)

    def contrasts(self) -> tuple[float, float]:
        """Return the contrast of the mobile as it is drawn and as it is observed; see `contrasts_of`."""
        before = self.drawn(), self.observed()
        groups = self._model.geom_group
        shown = groups[self._geoms]
        groups[self._geoms] = HIDDEN_GROUP
        try:
            without = self.drawn(), self.observed()
        finally:
            groups[self._geoms] = shown
        return contrasts_of(*(picture @ WEIGHTS for pair in zip(before, without, strict=True) for picture in pair))

    def close(self) -> None:
        """Free the OpenGL context."""
        self._vision.close()


def contrasts_of(
    drawn: Luminance, drawn_without: Luminance, observed: Luminance, observed_without: Luminance
) -> tuple[float, float]:
    """Return the contrast of a thing as it is drawn and as it is observed, from pictures with and without it.

    It is the root mean square of the difference in luminance that the thing makes, over the pixels in which it is
    drawn, divided by the mean luminance that is drawn without it. Nothing drawn has none. All have the shape
    (eyes, height, width).
    """
    change = drawn - drawn_without
    is_it = change != 0
    if not is_it.any():
        return 0.0, 0.0
    changes = change[is_it], (observed - observed_without)[is_it]
    mean = max(float(drawn_without.mean()), 1.0)
    as_drawn, as_observed = (float(np.sqrt(np.mean(values**2))) / mean for values in changes)
    return as_drawn, as_observed


@cache
def lying(age_months: float, size_px: int = 0) -> Bundle:
    """Return an average child on its back under the mobile; without pictures (0 pixels), it is simulated faster."""
    senses = {"vision": {**VISION, "width_px": size_px, "height_px": size_px}} if size_px else {}
    actuation, delays = {"model": "muscle"}, {"processing": "age"}
    scene = {"kind": "crib", "pose": "supine", "objects": [dict(MOBILE)]}
    return build(child("regard", age_months, senses=senses, actuation=actuation, delays=delays, scene=scene))


def watch(case: Case, seed: int) -> TrialResult:
    """Return what an infant has before its eyes while it lies under the mobile."""
    with (
        closing(InfantEnv(lying(case.age_months, SEEING_PX.get(case.condition, 0)))) as env,
        closing(Pictures(lying(case.age_months, SIZE_PX))) as pictures,
    ):
        run = Run(env, POLICIES[case.condition], seed)
        watcher = Watcher(env, pictures.entry)
        step_s = env.manifest.step_ms / 1000
        contrasts = list[tuple[float, float]]()
        for step in range(round(case.seconds / step_s)):
            run.step()
            watcher.gaze()
            if (step + 1) % round(WATCHED_S / step_s) == 0:
                watcher.watch()
            if (step + 1) % round(PICTURED_S / step_s) == 0:
                pictures.place(env.data.qpos)
                contrasts.append(pictures.contrasts())
        return TrialResult(values=watcher.values() | _contrast_values(contrasts))


class Watcher:
    """Counts what an infant has before its eyes."""

    def __init__(self, env: InfantEnv, entry: VisionEntry):
        """Begin with an infant that has just been reset, and eyes as mature as *entry* says."""
        mobile = env.manifest.objects[0]
        self._sight = Sight(env, entry)
        self._data = env.data
        self._step_s = env.manifest.step_ms / 1000
        self._body, self._mobile = env.model.body(mobile.body).id, self._sight.thing(mobile.body, mobile.geoms)
        self._hands = [self._sight.thing(f"{side}_hand") for side in SIDES]
        self._noticed_deg = entry.noticed_deg or 90.0
        self._angles_deg = list[float]()
        self._instants = list[Mapping[str, bool]]()
        self._depths_m = list[float]()

    def gaze(self) -> None:
        """See how far the gaze is from the mobile; once after each control step."""
        self._angles_deg.append(self._sight.gaze_deg(self._data.xipos[self._body]))

    def watch(self) -> None:
        """See what is before the eyes."""
        hands = [self._sight.points(hand) for hand in self._hands]
        mobile = self._sight.points(self._mobile)
        regard = hand_regard(hands, self._noticed_deg)
        self._instants.append({"mobile_noticed": mobile.within(self._noticed_deg), **regard})
        for hand in hands:
            self._depths_m += hand.depths_m[hand.angles_deg <= self._noticed_deg].tolist()

    def values(self) -> dict[str, float]:
        """Return shares of the time, [%], when the gaze came to the mobile, and how far hands were."""
        values = {name: 100 * float(np.mean([item[name] for item in self._instants])) for name in self._instants[0]}
        is_on = np.array(self._angles_deg) <= ON_DEG
        values |= {"gaze_on": 100 * float(is_on.mean()), "gaze_deg": float(np.median(self._angles_deg))}
        if (onset_s := gaze_onset_s(is_on, self._step_s)) is not None:
            values["onset_s"] = onset_s
        if self._depths_m:
            values["hand_cm"] = 100 * float(np.median(self._depths_m))
        return values


def hand_regard(hands: Sequence[Points], noticed_deg: float) -> dict[str, bool]:
    """Return whether one of the hands is before the eyes: in the noticed field, in focus there, near the middle."""
    return {
        "hand_noticed": any(hand.within(noticed_deg) for hand in hands),
        "hand_regarded": any(hand.within(noticed_deg, sharp=True) for hand in hands),
        "hand_near": any(hand.within(NEAR_DEG) for hand in hands),
    }


def gaze_onset_s(is_on: npt.NDArray[np.bool_], step_s: float) -> float | None:
    """Return when the gaze first was on something for `ON_S`, from whether it was after each step; None for never."""
    count = round(ON_S / step_s)
    runs = np.convolve(is_on, np.ones(count), "valid") if len(is_on) >= count else np.zeros(0)
    (starts,) = np.nonzero(runs > count - 0.5)
    return float(starts[0] + 1) * step_s if len(starts) else None


def _contrast_values(contrasts: Sequence[tuple[float, float]]) -> dict[str, float]:
    """Return the mean contrast of the mobile in pictures in which it is drawn, as drawn and as observed, [%]."""
    shown = 100 * np.array([pair for pair in contrasts if pair[0]]).reshape(-1, 2)
    values = {"pictured": 100 * len(shown) / max(len(contrasts), 1)}
    if not len(shown):
        return values
    drawn, observed = shown.mean(axis=0)
    return {**values, "contrast_drawn": float(drawn), "contrast_observed": float(observed)}


def _views(results: Results) -> bytes:
    drawn, observed = list[Picture](), list[Picture]()
    months = _months(results)
    for age_months in months:
        with closing(Pictures(lying(age_months, SIZE_PX))) as pictures:
            drawn.append(pictures.drawn()[0])
            observed.append(pictures.observed()[0])
    columns = [f"{age_months:g} months" for age_months in months]
    return encode_palette_png(tile_pictures([drawn, observed], columns, ("drawn", "observed")), COLOURS)


def _months(results: Results) -> list[float]:
    return list(dict.fromkeys(case.age_months for case in results.by_case))


def _plots(results: Results) -> Iterator[Plot]:
    months = _months(results)

    def curve(condition: str, name: str, label: str) -> tuple[Line, Band]:
        cases = [case for case in results.by_case if case.condition == condition]
        ends = [interval(results.values(case, name) or [0.0]) for case in cases]
        low = [max(0.0, item.low) for item in ends]
        high = [min(100.0, item.high) for item in ends]
        return Line(months, [item.mean for item in ends], label), Band(months, low, high, label)

    seen = [curve(name, "mobile_noticed", label) for name, label in LABELS.items()]
    yield Plot(AGE, SHARE, *zip(*seen, strict=True), title="The mobile is in the noticed field", y_range=(0.0, 105.0))
    contrasts = [curve("looks", f"contrast_{name}", name) for name in ("drawn", "observed")]
    yield Plot(AGE, CONTRAST, *zip(*contrasts, strict=True), title="Contrast of the mobile that is looked at")
    names = {"hand_noticed": "noticed", "hand_regarded": "and in focus", "hand_near": f"within {NEAR_DEG:g}°"}
    hands = [curve("moves", name, label) for name, label in names.items()]
    hands.append(curve("sees", "hand_near", f"within {NEAR_DEG:g}°, looks around"))
    published = Dots(HEAD_CAMERA_MONTHS, [100 * HEAD_CAMERA_SHARE] * 2, "head cameras, any hands (from memory)")
    lines, bands = zip(*hands, strict=True)
    yield Plot(AGE, SHARE, lines, bands, (published,), title="A hand of its own is before the eyes")


def _numbers(results: Results) -> dict[str, object]:
    mobiles, hands = zip(*_rows(results), strict=True)
    return {
        "months": ", ".join(f"{age_months:g}" for age_months in _months(results)),
        "seconds": next(iter(results.by_case)).seconds,
        "size": SIZE_PX,
        "fovy": VISION["fovy_deg"],
        "on_deg": ON_DEG,
        "near_deg": NEAR_DEG,
        "mobiles": table_rows(mobiles),
        "hands": table_rows(hands),
        "answer": _answer(results),
    }


def _rows(results: Results) -> Iterator[tuple[tuple[str, ...], tuple[str, ...]]]:
    """Yield a row on the mobile and a row on hands of each case."""
    names = ("mobile_noticed", "gaze_on", "gaze_deg", "hand_noticed", "hand_regarded", "hand_near")
    for case in results.by_case:
        what = (f"{case.age_months:g}", LABELS[case.condition])
        onsets_s = results.values(case, "onset_s")
        shares = [results.mean(case, name).text(0) for name in names]
        values = (results.values(case, name) for name in ("contrast_drawn", "contrast_observed", "hand_cm"))
        *contrasts, hand = (f"{np.mean(some):.0f}" if some else "never" for some in values)
        onset = f"{np.median(onsets_s):.1f} s in {len(onsets_s)} of {len(results.seeds)}" if onsets_s else "never"
        yield (*what, *shares[:3], onset, *contrasts), (*what, *shares[3:], hand)


def _answer(results: Results) -> str:
    def mean(case: Case, name: str) -> float:
        values = results.values(case, name)
        return float(np.mean(values)) if values else float("nan")

    moving, seeing, looking = ([case for case in results.by_case if case.condition == name] for name in POLICIES)
    ages = [case.age_months for case in moving]
    ends = (moving[0], moving[-1])
    kept = [100 * mean(case, "contrast_observed") / mean(case, "contrast_drawn") for case in (looking[0], looking[-1])]
    hands, near = ([mean(case, name) for case in ends] for name in ("hand_regarded", "hand_near"))
    found = [[mean(case, name) for case in (seeing[0], seeing[-1])] for name in ("gaze_on", "hand_near")]
    return (
        f"From {ages[0]:g} to {ages[-1]:g} months, the share of the mobile's contrast that an infant observes goes "
        f"from {kept[0]:.0f} to {kept[1]:.0f} % while it looks at it. A hand of its own is in the noticed field and in "
        f"focus for {hands[0]:.0f} and {hands[1]:.0f} % of the time while it only moves, and within {NEAR_DEG:g} "
        f"degrees of the line of sight, whatever it notices, for {near[0]:.0f} and {near[1]:.0f} %. "
        f"While it looks around at what its eyes see, its gaze is on the mobile for {found[0][0]:.0f} and "
        f"{found[0][1]:.0f} % of the time, and a hand is so near to the line of sight for {found[1][0]:.0f} and "
        f"{found[1][1]:.0f} %."
    )


EXPERIMENT = Experiment(
    name="regard",
    trial=watch,
    cases=grid(Case, condition=POLICIES, age_months=MONTHS, seconds=(30.0,)),
    seeds=range(5),
    quick={"seeds": range(1), "cases": grid(Case, condition=POLICIES, age_months=(0, 4), seconds=(5.0,))},
    files={
        "regard.csv": measures_table(condition="condition", age_months="age_months"),
        "regard.png": _plots,
        "views.png": _views,
    },
    page=PAGES / "regard.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: (lying(age_months) for age_months in MONTHS),
)
