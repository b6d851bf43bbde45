"""The voice of an infant: from where and how high its two commands, pitch and loudness, can let it sound."""

from collections.abc import Iterator

import numpy as np

from mimoc.body.head_surface import as_on_mimos_head
from mimoc.body.origins import Entry, Origin
from mimoc.body.tree import BodyTree
from mimoc.schema.actuation import VoiceEntry

CALM_MONTHS, CALM_HZ = (0.0, 3.0, 6.0, 9.0), (335.0, 445.0, 450.0, 415.0)
"""Mean fundamental frequency of calm sounds by age: Laufer & Horii 1977 (0 to 24 weeks), Kent & Murray 1982 (3, 6 and
9 months). There is none of later months."""
BELOW_CALM = 2**-0.5
"""Lowest frequency, relative to that: half an octave below; assumed."""
HIGHEST_HZ = 583.0 + 2 * 151.0
"""Mean of the highest frequency of cries, and two standard deviations (1 to 7 days, n 172; Michelsson et al. 2002)."""
LOUDEST_DB = 85.0
"""Of a cry, at 1 m; assumed."""
MOUTH_M = (0.066, 0.0, 0.02)
"""On MIMo's head: below the nose."""


def voice_of(tree: BodyTree) -> VoiceEntry:
    """Return the voice of a body."""
    return VoiceEntry(
        head="head",
        mouth_m=as_on_mimos_head(tree.geoms["head"], MOUTH_M),
        low_hz=BELOW_CALM * float(np.interp(tree.age_months, CALM_MONTHS, CALM_HZ)),
        high_hz=HIGHEST_HZ,
        loudest_db=LOUDEST_DB,
    )


def trace_voice(voice: VoiceEntry | None) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each number of a voice, if there is one."""
    if voice is None:
        return
    calm = "half an octave below calm sounds (Laufer & Horii 1977, Kent & Murray 1982; by how much is assumed)"
    cry = "mean of the highest frequency of cries + 2 SD, 583 + 2 x 151 Hz (Michelsson et al. 2002)"
    rules = {
        "low_hz": Origin(calm, ("spec.actuation.voice", "spec.age_months"), "Hz"),
        "high_hz": Origin(cry, ("spec.actuation.voice",), "Hz"),
        "loudest_db": Origin("a cry at 1 m, assumed", ("spec.actuation.voice",), "dB"),
    }
    for name, origin in rules.items():
        yield f"actuation.voice.{name}", origin.entry(getattr(voice, name))
