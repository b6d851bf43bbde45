"""Acuity and foveation: one scene as seen at several ages (López et al. 2025, figure 3), and gratings."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.base.quantities import AGE, Quantity
from mimoc.bundle.io import Bundle
from mimoc.compiler import building
from mimoc.compiler.looks.pictures import encode_palette_png
from mimoc.components.senses.vision import VisionEntry, VisionSpec
from mimoc.components.senses.vision.build import PROFILES, acuity_at
from mimoc.components.senses.vision.foveation import pixels_per_degree
from mimoc.components.senses.vision.preview import DEFAULT_FOVEATION, compare_ages, preview
from mimoc.components.senses.vision.run import filters, perceive
from mimoc.render.picture_files import tile_pictures
from mimoc.render.plots import Dots, Line, Plot
from mimoc.schema.names import Development
from mimoc.studies.experiment import Experiment, Measured, Results, Table, child
from mimoc.studies.notebook import PAGES, markdown_table, months_text

FOVY_DEG = VisionSpec().fovy_deg
PROFILE = VisionSpec().acuity_profile

WIDTH_PX, HEIGHT_PX = 8, 2048  # Size of an image of horizontal bars: fine enough for the acuity at two years.
MEAN, AMPLITUDE = 127.5, 120.0  # Mean and amplitude of a grating's brightness, in a range of 0 to 255.
SHARES_OF_ACUITY: Sequence[float] = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.05, 1.2)

PAPER_MONTHS: Sequence[float] = (1, 2, 4, 6, 12)
SEED = 4  # Seed of the room.
SIDE = "left"  # Side of the eye.
DOWN_DEG = 35.0  # Downward gaze, towards the toys.
SIZE_PX, QUICK_SIZE_PX = 176, 64  # Size of each view.
MIDDLE_TIMES = 4  # Magnification of the middle of the view in the last row.
COLOURS = 256  # Number of colours of the figure, which makes its file a third as large.
FOVEATION = "strength of the foveation that is shown"  # Name of the paper's figure.
HALF = 0.5  # The grating nearest to this share of the acuity is compared with the paper.
HALF_MONTHS: Sequence[float] = [half / 2 for half in range(49)]  # Ages of the curves, in steps of half a month.


@dataclass(frozen=True, slots=True)
class Transfer:
    """The fraction of a grating's contrast that remains after the filter."""

    age_months: float
    acuity_cpd: float
    frequency_cpd: float
    measured: float

    @property
    def law(self) -> float:
        """The fraction predicted by the contrast sensitivity function (López et al. 2025, equation 2)."""
        return max(0.0, 1 - self.frequency_cpd / self.acuity_cpd)


def transfers(age_months: float, acuity_cpd: float) -> Iterator[Transfer]:
    """Yield the remaining contrast of gratings of several spatial frequencies."""
    eye = VisionEntry(
        cameras=("eye_left",),
        width_px=WIDTH_PX,
        height_px=HEIGHT_PX,
        supersample=1,
        acuity_cpd=acuity_cpd,
        foveation=0.0,
        foveation_radius="border",
        unseen=(),
    )
    seen_by = filters(eye, FOVY_DEG)
    half_cycle_cpd = pixels_per_degree(HEIGHT_PX, FOVY_DEG) / (2 * HEIGHT_PX)
    for share in SHARES_OF_ACUITY:
        # A whole number of half cycles has no effects at the border.
        half_cycles = max(1, round(share * acuity_cpd / half_cycle_cpd))
        wave = np.cos(np.pi * half_cycles * (np.arange(HEIGHT_PX) + 0.5) / HEIGHT_PX)
        grating = np.rint(MEAN + AMPLITUDE * wave).astype(np.uint8)
        seen = perceive(np.broadcast_to(grating[None, :, None, None], (1, HEIGHT_PX, WIDTH_PX, 3)), seen_by)
        before, after = (float(picture.astype(float) @ wave) for picture in (grating, seen[0, :, 0, 0]))
        yield Transfer(age_months, acuity_cpd, half_cycles * half_cycle_cpd, after / before)


def try_gratings(age_months: float, seed: int) -> list[Transfer]:
    """Return what the eyes of an age leave of gratings."""
    return list(transfers(age_months, acuity_at(age_months, PROFILE)))


def _gratings(results: Results) -> list[Transfer]:
    return [transfer for (of_age,) in results.by_case.values() for transfer in of_age]


def _measured(results: Results) -> Measured:
    measured = _gratings(results)
    half = min(measured, key=lambda transfer: abs(transfer.frequency_cpd / transfer.acuity_cpd - HALF))
    acuities = {
        f"acuity at {months_text(age)} [cycles/degree], `mimo_v2`": acuity_at(age, "mimo_v2") for age in PAPER_MONTHS
    }
    return {**acuities, "contrast left at half the acuity": half.measured, FOVEATION: DEFAULT_FOVEATION}


def infants(law: Development) -> Iterator[Bundle]:
    """Yield the infant that looks."""
    scene = {"kind": "room", "pose": "sitting", "toys": {"count": [6, 6], "size_cm": [8, 14]}}
    yield building.builder(child("onlooker", 10, development=law, scene=scene))(SEED, check=False)


def _size_px(results: Results) -> int:
    return QUICK_SIZE_PX if results.notebook.quick else SIZE_PX


def _sheet(results: Results) -> bytes:
    """Return the PNG of one view, processed in several ways (rows) and at several ages (columns)."""
    infant = next(infants(results.notebook.law))
    size_px = _size_px(results)
    whole, finer = (
        compare_ages(VisionSpec(), SIDE, PAPER_MONTHS, times * size_px, foveation=DEFAULT_FOVEATION)
        for times in (1, MIDDLE_TIMES)
    )
    pictures = preview(infant, whole.entries, down_deg=DOWN_DEG)
    (acuity_row,) = (entries for name, entries in zip(finer.rows, finer.entries, strict=True) if name == "acuity")
    (larger,) = preview(infant, [acuity_row], down_deg=DOWN_DEG)
    start = (len(larger[0]) - size_px) // 2
    middles = [picture[start : start + size_px, start : start + size_px] for picture in larger]
    middle_deg = 2 * math.degrees(math.atan(math.tan(math.radians(FOVY_DEG / 2)) / MIDDLE_TIMES))
    rows = (*whole.rows, f"acuity, middle {middle_deg:.0f} degrees")
    return encode_palette_png(tile_pictures([*pictures, middles], whole.columns, rows), COLOURS)


def _profiles(results: Results) -> Table:
    heading = ",".join(("age_months", *(f"{profile}_cpd" for profile in PROFILES)))
    return heading, ((age, *(acuity_at(age, profile) for profile in PROFILES)) for age in HALF_MONTHS)


def _plots(results: Results) -> list[Plot]:
    profiles = {profile: [acuity_at(age_months, profile) for age_months in HALF_MONTHS] for profile in PROFILES}
    lines = tuple(Line(HALF_MONTHS, acuities_cpd, profile) for profile, acuities_cpd in profiles.items())
    by_profile = Plot(AGE, Quantity("acuity_cpd", "Acuity", "cycles/degree"), lines, title="Acuity by age")
    return [_csf_plot([of_age for (of_age,) in results.by_case.values()]), by_profile]


def _csf_plot(by_age: Sequence[Sequence[Transfer]]) -> Plot:
    lines, dots = [], []
    for of_age in by_age:
        label = months_text(of_age[0].age_months)
        frequencies_cpd = [transfer.frequency_cpd for transfer in of_age]
        lines.append(Line((0, of_age[0].acuity_cpd), (1, 0), label))
        dots.append(Dots(frequencies_cpd, [transfer.measured for transfer in of_age], label))
    x = Quantity("frequency_cpd", "Spatial frequency", "cycles/degree")
    y = Quantity("contrast", "Remaining contrast")
    return Plot(x, y, tuple(lines), dots=tuple(dots), title="Contrast sensitivity")


def _numbers(results: Results) -> dict[str, object]:
    measured = _gratings(results)
    size_px = _size_px(results)
    rows = (
        [f"{age_months:g}", *(f"{acuity_at(age_months, profile):.2f}" for profile in PROFILES)]
        for age_months in PAPER_MONTHS
    )
    return {
        "room": SEED,
        "side": SIDE,
        "ages": ", ".join(f"{age_months:g}" for age_months in PAPER_MONTHS),
        "foveation": DEFAULT_FOVEATION,
        "magnification": DEFAULT_FOVEATION / math.log1p(DEFAULT_FOVEATION),
        "profile": PROFILE,
        "table": markdown_table(("months", *(f"`{profile}` [cycles/degree]" for profile in PROFILES)), rows),
        "count": len(measured),
        "error": max(abs(transfer.measured - transfer.law) for transfer in measured),
        "fovy": FOVY_DEG,
        "size": size_px,
        "shown": size_px / (2 * FOVY_DEG),
        "shown_middle": MIDDLE_TIMES * size_px / (2 * FOVY_DEG),
    }


EXPERIMENT = Experiment(
    name="acuity",
    trial=try_gratings,
    cases=lambda notebook: PAPER_MONTHS,
    kept=False,
    files={
        "acuity.png": _sheet,
        "profiles.csv": _profiles,
        "gratings.csv": lambda results: (
            "age_months,acuity_cpd,frequency_cpd,law,measured",
            (
                (transfer.age_months, transfer.acuity_cpd, transfer.frequency_cpd, transfer.law, transfer.measured)
                for transfer in _gratings(results)
            ),
        ),
        "csf.png": _plots,
    },
    page=PAGES / "acuity.md",
    numbers=_numbers,
    measured=_measured,
    infants=infants,
    development="maturing",
)
