"""Which measurements the factors of parts change, on compiled bodies."""

from itertools import product

from mimoc.compiler.validation.measuring import measure_body
from mimoc.schema.names import limb_bodies, trunk_bodies
from mimoc.schema.sizes import PART_SIZES

FACTOR = 1.05
SUMS = {"crown_rump_length", "crown_sole_length", "rump_sole_length"}
"""Measurements over many parts, of which none alone is the size."""
FIVE_FINGER = ("left_hand", "left_mfknuckle", "left_thbase", "left_toes")
"""The parts that measurements are of with one kind of hands only."""


def test_a_part_names_the_measurements_that_its_factors_change_by_half_or_more(infant_at, infant_with):
    """None is left out that changes by .55 of a factor, and none is there that changes by less than .4."""
    mitten = [name for name in (*trunk_bodies(), *limb_bodies("mitten")) if not name.startswith("right_")]
    shares: dict[tuple[str, str, str], float] = {}
    for hands, parts in {"mitten": mitten, "five_finger": FIVE_FINGER}.items():
        before = measure_body(infant_at(9, hands).model)
        for part, key in product(parts, ("length", "girth")):
            after = measure_body(infant_with(hands=hands, parts={part: {key: FACTOR}}).model)
            for name in before.keys() - SUMS:
                told = part.removeprefix("left_"), key, name
                shares[told] = max(shares.get(told, 0.0), (after[name] / before[name] - 1) / (FACTOR - 1))
    named = {(part, key, name) for part, keys in PART_SIZES.items() for key, names in keys.items() for name in names}
    assert {told for told, share in shares.items() if share > 0.55} <= named
    assert {told for told in named if shares[told] < 0.4} == set()
