"""Further measures of spontaneous movement, which a distance between infants does not count.

Figures of 12 real infants for most of them are in `mimoc/movement/real_infants.csv`.
"""

from mimoc.base.quantities.movement import of_recording
from mimoc.base.quantities.quantity import Quantity

ADDE = "Adde et al. 2009, Early Hum Dev 85: 541"
HIGUCHI = "Higuchi 1988, Physica D 31: 277"
THELEN = "Thelen & Fisher 1983, J Mot Behav 15: 353"
TRUJILLO = "Trujillo-Priego & Smith 2017, J Rehabil Assist Technol Eng 4"
VON_HOFSTEN = "von Hofsten & Rönnqvist 1993, Child Dev 64: 1046"


def _of_end(part: str) -> list[Quantity]:
    label = part.capitalize()
    return [
        of_recording(name.format(part), f"{label}: {what}", unit, about, source)
        for name, what, unit, about, source in (
            (
                "{}_unit_s",
                "duration of a movement unit",
                "s",
                "median time from the minimum of the speed before a movement unit to that after it",
                VON_HOFSTEN,
            ),
            ("{}_unit_peak_trunk_s", "peak speed of a unit", "trunk/s", "median of the movement units' maxima", None),
            ("{}_speed_max_trunk_s", "largest speed", "trunk/s", "largest of all frames and both sides", None),
            (
                "{}_moving_mean_s",
                "time in motion, mean",
                "s",
                "mean length of runs of frames faster than .25 trunk/s, without those cut by the recording's ends",
                None,
            ),
            ("{}_moving_p90_s", "time in motion, 90th percentile", "s", "90th percentile of the same lengths", None),
            (
                "{}_still_mean_s",
                "pause, mean",
                "s",
                "mean length of runs of frames that are not faster than .25 trunk/s, likewise",
                None,
            ),
            ("{}_still_p90_s", "pause, 90th percentile", "s", "90th percentile of the same lengths", None),
            (
                "{}_path_dimension",
                "complexity of the path",
                "",
                "Higuchi's fractal dimension of the position over time, steps of .1 to .8 s: 1 for a smooth path, 1.5"
                " for a random walk, 2 for noise; mean of sides",
                HIGUCHI,
            ),
        )
    ]


def _of_joint(part: str, speed: bool) -> list[Quantity]:
    label = part.capitalize()
    acceleration = of_recording(
        f"{part}_acceleration_p95_trunk_s2",
        f"{label}: acceleration, 95th percentile",
        "trunk/s²",
        "95th percentile over frames and both sides of the length of the velocity's central difference",
    )
    about = "95th percentile over frames and both sides"
    fast = of_recording(f"{part}_speed_p95_trunk_s", f"{label}: speed, 95th percentile", "trunk/s", about)
    return [*([fast] if speed else []), acceleration]


_BODY = (
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
)
CENTROID = of_recording(
    "centroid_spread_trunk",
    "Body: spread of the centroid of motion (CSM)",
    "trunk",
    "square root of the sum of the variances, over frames with motion, of the mean position of hands, elbows, knees and"
    " feet weighted by their speeds above .25 trunk/s; of points in the trunk's frame, so not the figures of pixels",
    ADDE,
)
_PLACES = (
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
)
_LEGS = (
    ("leg_length_median_trunk", "Leg: hip to foot, median", "trunk", "median of both legs' distance from hip to foot"),
    ("leg_length_p2_trunk", "Leg: hip to foot, 2nd percentile", "trunk", "2nd percentile: the leg folded most"),
    ("leg_length_p98_trunk", "Leg: hip to foot, 98th percentile", "trunk", "98th percentile: the leg nearly straight"),
    ("kick_amplitude_trunk", "Leg: amplitude of a kick", "trunk", "median prominence of kicks of both legs"),
    (
        "kick_extension_s",
        "Leg: extension phase of a kick",
        "s",
        "mean time from the minimum of the distance from hip to foot before a kick to its maximum",
    ),
    ("kick_flexion_s", "Leg: flexion phase of a kick", "s", "mean time from its maximum to the minimum after it"),
    (
        "kick_extension_rate_trunk_s",
        "Leg: peak rate of extension",
        "trunk/s",
        "mean over kicks of the largest rate of the distance from hip to foot in the extension phase",
    ),
    (
        "kick_flexion_rate_trunk_s",
        "Leg: peak rate of flexion",
        "trunk/s",
        "mean over kicks of the largest rate at which it falls in the flexion phase",
    ),
    (
        "kick_acceleration_trunk_s2",
        "Leg: peak acceleration of the foot in a kick",
        "trunk/s²",
        "mean over kicks of the largest acceleration of the foot, as seen",
    ),
    ("legs_together_r", "Legs: left and right", "", "Pearson correlation of left and right distance from hip to foot"),
    ("kicks_together_share", "Legs: kicks together", "", "share of kicks with one of the other leg within .2 s"),
)
_JOINTS = (
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
_MOVEMENTS = (
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
DETAILS = (
    *(*_of_end("hand"), *_of_end("foot")),
    *(item for part in ("hand", "foot", "elbow", "knee") for item in _of_joint(part, part in ("elbow", "knee"))),
    *(of_recording(*row) for row in _BODY),
    CENTROID,
    *(of_recording(*row) for row in _PLACES),
    *(of_recording(*row, THELEN if row[0].startswith("kick_") else None) for row in _LEGS),
)
"""What further is measured of any recording."""
JOINTS = (*(of_recording(*row, THELEN) for row in _JOINTS), *(of_recording(*row, TRUJILLO) for row in _MOVEMENTS))
"""What is measured where places in space are known: of simulated infants, of markers, with a depth camera. Angles are
those between the lines of points: at the hip trunk and thigh, at the knee thigh and shank, at the ankle shank and
foot."""
