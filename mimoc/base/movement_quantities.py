"""Measures of movement: of points on a real or a simulated infant, and of the movement columns of an episode.

The 21 measures of `CORE` are those that infants are compared by, which a distance between infants counts. All lengths
in them are in lengths of the trunk, from the neck to the middle of the hips, in its own frame: they depend neither on
the size of the infant and its distance from the camera, nor on how it lies or travels. Figures of 12 real infants for
most measures of points are in `mimoc/movement/real_infants.csv`.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

from mimoc.base.quantity import Quantity

ADDE = "Adde et al. 2009, Early Hum Dev 85: 541"
DIMERCURIO = "DiMercurio et al. 2018, Front Psychol 9: 2613"
HIGUCHI = "Higuchi 1988, Physica D 31: 277"
THELEN = "Thelen & Fisher 1983, J Mot Behav 15: 353"
TRUJILLO = "Trujillo-Priego & Smith 2017, J Rehabil Assist Technol Eng 4"
VON_HOFSTEN = "von Hofsten & Rönnqvist 1993, Child Dev 64: 1046"

Rows = Sequence[tuple[str, ...]]
"""Name, label, unit, definition and, where there is one, source; `{0}` stands for a part, `{1}` for both of them."""


def _of_recording(rows: Rows, part: str = "", parts: str = "") -> Iterator[Quantity]:
    for name, label, unit, about, *source in rows:
        name = name.format(part, parts)
        label = label.format(part.capitalize(), parts.capitalize())
        yield Quantity(name, label, unit, about, over="recording", steps=(), source=source[0] if source else None)


_P95 = "95th percentile over frames and both sides"
_SPEED_P95 = ("{0}_speed_p95_trunk_s", "{0}: speed, 95th percentile", "trunk/s", _P95)
_ENDS: Rows = (
    (
        "{0}_speed_median_trunk_s",
        "{0}: speed, median",
        "trunk/s",
        "median speed over frames and both sides: length of the central difference of the position in the frame of the"
        " trunk, times frames per second",
    ),
    _SPEED_P95,
    ("{0}_moving_share", "{0}: share of time in motion", "", "share of frames of both sides faster than .25 trunk/s"),
    (
        "{0}_spread_trunk",
        "{0}: spread",
        "trunk",
        "square root of the sum of the variances of the position across and along the trunk; mean of both sides",
    ),
    (
        "{0}_sample_entropy_nats",
        "{0}: sample entropy of speed",
        "nats",
        "unpredictability of the speed, standardised, at 10 Hz: -ln(A / B), where B pairs of 2 successive values differ"
        " by less than .2, and A of these also in the next value; mean of both sides",
        "Richman & Moorman 2000, Am J Physiol 278: H2039",
    ),
    ("{0}_burstiness", "{0}: burstiness", "", "excess kurtosis of the speed; mean of both sides"),
    (
        "{0}_frequency_hz",
        "{0}: frequency, median",
        "Hz",
        "frequency below which half of the power of the velocity lies; Welch's spectra (Hann windows of 8.5 s,"
        " overlapping by half), summed over both sides and both axes",
        "Welch 1967, IEEE Trans Audio Electroacoust 15: 70",
    ),
    ("{1}_together_r", "{1}: speeds of left and right", "", "Pearson correlation of the speeds of left and right"),
    (
        "{0}_units_per_min",
        "{0}: movement units",
        "1/min",
        "maxima of the speed of at least .25 trunk/s, with a prominence of at least .125 trunk/s; mean of both sides",
    ),
)
_WHOLE: Rows = (
    (
        "kicks_per_min",
        "Leg: kicks",
        "1/min",
        "maxima of the distance from hip to foot with a prominence of at least .25 trunk; mean of both legs",
    ),
    (
        "hand_foot_together_r",
        "Hand and foot: speeds of one side",
        "",
        "Pearson correlation of the speeds of hand and foot of the same side; mean of both sides",
    ),
    (
        "dimensions",
        "Body: dimensions of movement",
        "",
        "participation ratio (sum of l)^2 / (sum of l^2) of the eigenvalues l of the covariance of the 16 coordinates"
        " of hands, elbows, feet and knees",
    ),
)
CORE = (*_of_recording(_ENDS, "hand", "hands"), *_of_recording(_ENDS, "foot", "feet"), *_of_recording(_WHOLE))
"""The 21 measures, in the order in which they are computed."""

_END_DETAILS: Rows = (
    (
        "{0}_unit_s",
        "{0}: duration of a movement unit",
        "s",
        "median time from the minimum of the speed before a movement unit to that after it",
        VON_HOFSTEN,
    ),
    ("{0}_unit_peak_trunk_s", "{0}: peak speed of a unit", "trunk/s", "median of the movement units' maxima"),
    ("{0}_speed_max_trunk_s", "{0}: largest speed", "trunk/s", "largest of all frames and both sides"),
    (
        "{0}_moving_mean_s",
        "{0}: time in motion, mean",
        "s",
        "mean length of runs of frames faster than .25 trunk/s, without those cut by the recording's ends",
    ),
    ("{0}_moving_p90_s", "{0}: time in motion, 90th percentile", "s", "90th percentile of the same lengths"),
    (
        "{0}_still_mean_s",
        "{0}: pause, mean",
        "s",
        "mean length of runs of frames that are not faster than .25 trunk/s, likewise",
    ),
    ("{0}_still_p90_s", "{0}: pause, 90th percentile", "s", "90th percentile of the same lengths"),
    (
        "{0}_path_dimension",
        "{0}: complexity of the path",
        "",
        "Higuchi's fractal dimension of the position over time, steps of .1 to .8 s: 1 for a smooth path, 1.5"
        " for a random walk, 2 for noise; mean of sides",
        HIGUCHI,
    ),
)
_ACCELERATION = (
    "{0}_acceleration_p95_trunk_s2",
    "{0}: acceleration, 95th percentile",
    "trunk/s²",
    f"{_P95} of the length of the velocity's central difference",
)
_BODY: Rows = (
    ("limbs_still_share", "Body: no limb in motion", "", "share of frames in which no hand or foot is faster than .25"),
    (
        "limbs_still_chance_share",
        "Body: no limb in motion, by chance",
        "",
        "the same share if the four limbs moved independently: product of their shares",
    ),
    ("limbs_moving_share", "Body: all limbs in motion", "", "share of frames in which both hands and feet are faster"),
    (
        "limbs_moving_chance_share",
        "Body: all limbs in motion, by chance",
        "",
        "the same share if the four limbs moved independently",
    ),
    (
        "centroid_spread_trunk",
        "Body: spread of the centroid of motion (CSM)",
        "trunk",
        "square root of the sum of the variances, over frames with motion, of the mean position of hands, elbows, knees"
        " and feet weighted by their speeds above .25 trunk/s; of points in the trunk's frame, so not the figures of"
        " pixels",
        ADDE,
    ),
    (
        "hand_above_shoulder_share",
        "Hand: above the shoulder",
        "",
        "share of time in which a hand is further along the trunk than the shoulder of its side; mean of both sides",
    ),
    (
        "hand_to_face_share",
        "Hand: at the face",
        "",
        "share of frames in which a hand is seen less than .4 trunk from the head or nose; either hand",
    ),
    ("hands_apart_trunk", "Hands: distance", "trunk", "median distance between both hands, as seen"),
    ("hands_touching_share", "Hands: together", "", "share of frames with hands less than .25 trunk apart, as seen"),
    ("feet_apart_trunk", "Feet: distance", "trunk", "median distance between both feet, as seen"),
    ("feet_touching_share", "Feet: together", "", "share of frames with feet less than .25 trunk apart, as seen"),
    ("leg_length_median_trunk", "Leg: hip to foot, median", "trunk", "median of both legs' distance from hip to foot"),
    ("leg_length_p2_trunk", "Leg: hip to foot, 2nd percentile", "trunk", "2nd percentile: the leg folded most"),
    ("leg_length_p98_trunk", "Leg: hip to foot, 98th percentile", "trunk", "98th percentile: the leg nearly straight"),
    ("kick_amplitude_trunk", "Leg: amplitude of a kick", "trunk", "median prominence of kicks of both legs", THELEN),
    (
        "kick_extension_s",
        "Leg: extension phase of a kick",
        "s",
        "mean time from the minimum of the distance from hip to foot before a kick to its maximum",
        THELEN,
    ),
    (
        "kick_flexion_s",
        "Leg: flexion phase of a kick",
        "s",
        "mean time from its maximum to the minimum after it",
        THELEN,
    ),
    (
        "kick_extension_rate_trunk_s",
        "Leg: peak rate of extension",
        "trunk/s",
        "mean over kicks of the largest rate of the distance from hip to foot in the extension phase",
        THELEN,
    ),
    (
        "kick_flexion_rate_trunk_s",
        "Leg: peak rate of flexion",
        "trunk/s",
        "mean over kicks of the largest rate at which it falls in the flexion phase",
        THELEN,
    ),
    (
        "kick_acceleration_trunk_s2",
        "Leg: peak acceleration of the foot in a kick",
        "trunk/s²",
        "mean over kicks of the largest acceleration of the foot, as seen",
        THELEN,
    ),
    ("legs_together_r", "Legs: left and right", "", "Pearson correlation of left and right distance from hip to foot"),
    ("kicks_together_share", "Legs: kicks together", "", "share of kicks with one of the other leg within .2 s"),
)
_JOINTS: Rows = (
    ("hip_excursion_deg", "Hip: excursion in a kick", "°", "median range of the hip's angle from minimum to minimum"),
    ("knee_excursion_deg", "Knee: excursion in a kick", "°", "median range of the knee's angle, likewise"),
    ("ankle_excursion_deg", "Ankle: excursion in a kick", "°", "median range of the ankle's angle, likewise"),
    ("hip_knee_r", "Leg: hip and knee", "", "Pearson correlation of the angles of hip and knee; mean of both legs"),
    ("knee_ankle_r", "Leg: knee and ankle", "", "Pearson correlation of the angles of knee and ankle; mean of both"),
    ("hip_ankle_r", "Leg: hip and ankle", "", "Pearson correlation of the angles of hip and ankle; mean of both legs"),
    ("hips_together_r", "Hips: left and right", "", "Pearson correlation of the angles of both hips"),
    ("hip_knee_lag_s", "Leg: knee after hip", "s", "lag of at most .5 s at which hip and knee correlate most; mean"),
    ("kick_hip_knee_r", "Leg: hip and knee in a kick", "", "mean over kicks of the correlation of their angles in it"),
    ("kick_knee_ankle_r", "Leg: knee and ankle in a kick", "", "mean over kicks of the correlation, likewise"),
    (
        "kick_foot_acceleration_m_s2",
        "Foot: peak acceleration",
        "m/s²",
        "mean over kicks of the largest acceleration of the foot, in space",
    ),
)
_MOVEMENTS: Rows = (
    (
        "leg_movement_s",
        "Leg: duration of a movement",
        "s",
        "mean time of the ankle's movement units, however small, in space",
    ),
    (
        "leg_movement_m_s2",
        "Leg: peak acceleration in a movement",
        "m/s²",
        "mean of the ankle's largest acceleration in each",
    ),
)
_HEAD: Rows = (
    (
        "head_midline_share",
        "Head: in the midline",
        "",
        "share of frames in which the head is turned aside by less than 20°: the face, from the middle of the ears to"
        " the nose, is that near to the plane across the line of the shoulders",
    ),
    ("head_aside_deg", "Head: turned aside, median", "°", "median of how far it is turned aside, to either side"),
    ("head_turning_deg_s", "Head: speed of turning", "°/s", "mean speed at which the head turns aside or back"),
)
DETAILS = (
    *(*_of_recording(_END_DETAILS, "hand"), *_of_recording(_END_DETAILS, "foot")),
    *(*_of_recording([_ACCELERATION], "hand"), *_of_recording([_ACCELERATION], "foot")),
    *(*_of_recording([_SPEED_P95, _ACCELERATION], "elbow"), *_of_recording([_SPEED_P95, _ACCELERATION], "knee")),
    *_of_recording(_BODY),
)
"""What further is measured of any recording."""
JOINTS = (
    *_of_recording([(*row, THELEN) for row in _JOINTS]),
    *_of_recording([(*row, TRUJILLO) for row in _MOVEMENTS]),
    *_of_recording(_HEAD),
)
"""What is measured where places in space are known: of simulated infants, of markers, with a depth camera. Angles are
those between the lines of points: at the hip trunk and thigh, at the knee thigh and shank, at the ankle shank and
foot. Those of the head need nose, ears and shoulders."""

Columns = Mapping[str, Any]


def _path_m(part: str, columns: Columns) -> float:
    return math.fsum(math.dist(*points) for points in pairwise(_points(part, columns)))


def _straightness(part: str, columns: Columns) -> float | None:
    points = list(_points(part, columns))
    path_m = _path_m(part, columns)
    return math.dist(points[0], points[-1]) / path_m if path_m else None


def _touching(part: str, columns: Columns) -> float:
    return _share(text != "" for text in columns[f"{part}_touches"])


def _looked_at(part: str, columns: Columns) -> float:
    return _share(text == part for text in columns["gaze_at"])


def _points(part: str, columns: Columns) -> Iterator[tuple[float, ...]]:
    return zip(*(map(float, columns[f"{part}_{axis}_m"]) for axis in "xyz"), strict=True)


def _share(flags: Iterable[bool]) -> float:
    values = list(flags)
    return sum(values) / len(values)


def _of_part(side: str, part: str) -> Iterator[Quantity]:
    name = f"{side}_{part}"

    def of(ending: str, label: str, unit: str, about: str, **how: Any) -> Quantity:
        title = f"{side.capitalize()} {part}: {label}"
        return Quantity(f"{name}_{ending}", title, unit, about, over="movement", steps=("run",), **how)

    yield of("speed_mean_m_s", "mean speed", "m/s", "mean speed of its centre of mass", field=f"{name}_speed_m_s")
    about = "largest speed of its centre of mass"
    yield of("speed_max_m_s", "peak speed", "m/s", about, field=f"{name}_speed_m_s", reduce="max")
    about = "largest upward force of what is fixed on it"
    yield of("load_max_n", "largest load", "N", about, field=f"{name}_ground_z_n", reduce="max")
    about = "length of the path of its centre of mass"
    yield of("path_m", "path", "m", about, compute=partial(_path_m, name))
    about = "distance from its first to its last place over the length of its path: 1 is straight"
    yield of("straightness", "straightness", "", about, compute=partial(_straightness, name))
    about = (
        "maxima of its speed in the frame of the trunk (neck and hips), without what is faster than 6 Hz, of at least"
        " .25 trunk/s, with a prominence of at least .125 trunk/s, as `mimoc movement` counts them, but in space"
    )
    yield of("movement_units", "movement units", "", about, compute="mimoc.movement.measures", source=VON_HOFSTEN)
    about = "share of rows in which it touches anything"
    yield of("touching_share", "share of time in contact", "", about, compute=partial(_touching, name))
    about = "share of rows in which the line of sight first meets it"
    yield of("looked_at_share", "share of time looked at", "", about, compute=partial(_looked_at, name))


TRUNK = "hip", "lower_body", "upper_body", "chest"
GAP_S = 0.2  # A contact that ends for less goes on.
APART = "; "  # Between the names of several things that one part touches.


def _is_touched(columns: Columns, parts: Sequence[str]) -> dict[str, list[bool]]:
    """Return for each hand in which rows it touches one of some parts of the own body."""
    texts = {side: columns[f"{side}_hand_touches"] for side in ("right", "left")}
    return {side: [not set(parts).isdisjoint(text.split(APART)) for text in texts[side]] for side in texts}


def _touches_per_min(parts: Sequence[str], columns: Columns) -> float | None:
    """Return how often a minute hands begin to touch some parts of the own body, both hands together."""
    times_s = [float(time_s) for time_s in columns["time_s"]]
    count = 0
    for touched in _is_touched(columns, parts).values():
        last_s = -math.inf
        for time_s, is_touched in zip(times_s, touched, strict=True):
            if is_touched:
                count += time_s - last_s > GAP_S
                last_s = time_s
    return 60.0 * count / (times_s[-1] - times_s[0]) if len(times_s) > 1 else None


def _self_touch_share(columns: Columns) -> float:
    return _share(map(any, zip(*_is_touched(columns, ("head", *TRUNK)).values(), strict=True)))


def _of_whole(name: str, label: str, unit: str, about: str, **how: Any) -> Quantity:
    return Quantity(name, label, unit, about, over="movement", steps=("run",), **how)


_HEAD_AND_GAZE = "mimoc.movement.head_and_gaze"
_BEGIN = f"how often they begin to touch {{}}; a contact that ends for less than {GAP_S:g} s goes on"
_OF_WHOLE = (
    _of_whole(
        "gaze_midline_share",
        "Gaze: in the midline",
        "",
        "share of rows in which the mean line of sight of the eyes is within 20° of the plane across the line of the"
        " shoulders",
        compute=_HEAD_AND_GAZE,
    ),
    _of_whole(
        "gaze_turning_deg_s",
        "Gaze: speed of turning",
        "°/s",
        "mean speed at which the line of sight turns in the world, with the eyes, the head and the body",
        compute=_HEAD_AND_GAZE,
    ),
    _of_whole(
        "hands_self_touch_share",
        "Hands: on the own head or trunk",
        "",
        "share of rows in which a hand touches the own head or trunk; either hand",
        compute=_self_touch_share,
    ),
    _of_whole(
        "hands_to_head_per_min",
        "Hands: touches of the head",
        "1/min",
        _BEGIN.format("the head, both hands together"),
        compute=partial(_touches_per_min, ("head",)),
        source=DIMERCURIO,
    ),
    _of_whole(
        "hands_to_trunk_per_min",
        "Hands: touches of the trunk",
        "1/min",
        _BEGIN.format("the trunk, both hands together"),
        compute=partial(_touches_per_min, TRUNK),
        source=DIMERCURIO,
    ),
)
OF_MOVEMENT = (
    *(quantity for part in ("hand", "foot") for side in ("right", "left") for quantity in _of_part(side, part)),
    *_OF_WHOLE,
)
"""What movement columns say of an episode: how each hand and foot moves, touches and bears, what is looked at, how the
gaze turns, and how hands touch the own body.

Lengths and speeds are those in the world, in metres and seconds, but for movement units, which are in trunks."""
