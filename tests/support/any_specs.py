"""A strategy for specs."""

from typing import get_args

from hypothesis import strategies as st

from mimoc.anatomy.parts import kinds_of_hands
from mimoc.schema import InfantSpec, PartSpec
from mimoc.schema.body import Clothes, EyeColour, HairColour, SkinTone
from mimoc.schema.names import MEASUREMENT_KEYS, SIDED_MEASUREMENT_KEYS, STRENGTH_GROUPS, limb_bodies, trunk_bodies

MINIMAL = {"mimoc": 1, "name": "x", "age_months": 9}

LOOKS = {
    "skin": st.sampled_from(get_args(SkinTone)),
    "hair": st.sampled_from(get_args(HairColour)),
    "eyes": st.sampled_from(get_args(EyeColour)),
    "clothes": st.none() | st.sampled_from(get_args(Clothes)),
}


def specs() -> st.SearchStrategy[InfantSpec]:
    hands = st.sampled_from(kinds_of_hands())
    timesteps_ms = st.sampled_from((1.0, 2.0, 2.5, 5.0))
    return st.builds(_spec, hands, timesteps_ms, st.data(), st.floats(0, 24))


def _spec(hands: str, timestep_ms: float, data: st.DataObject, age_months: float) -> InfantSpec:
    keys = st.sampled_from(MEASUREMENT_KEYS + SIDED_MEASUREMENT_KEYS)
    factors = st.floats(0.5, 2)
    delays_ms = st.none() | st.integers(0, 100).map(lambda steps: steps * timestep_ms)
    acuity = st.sampled_from(("off", "age", {"cpd": 4.2})) | st.floats(0, 36)
    bodies = st.sampled_from(trunk_bodies() + limb_bodies(hands))
    removable = [name for name in limb_bodies(hands) if name != "left_eye"]  # With an eye, it can see.
    parts = st.dictionaries(bodies, st.builds(PartSpec, length=factors, girth=factors), max_size=3)
    measurements = data.draw(st.dictionaries(keys, st.floats(0.1, 100), max_size=3))
    scaled, strength = data.draw(parts), data.draw(st.dictionaries(st.sampled_from(STRENGTH_GROUPS), factors))
    said = measurements or scaled or strength  # Of parts, which must not be removed then.
    return InfantSpec.model_validate(
        {
            **MINIMAL,
            "age_months": age_months,
            "body": {
                "hands": hands,
                "measurements": measurements,
                "parts": scaled,
                "looks": {name: data.draw(looks) for name, looks in LOOKS.items()},
                "remove": [] if said else data.draw(st.lists(st.sampled_from(removable), unique=True, max_size=3)),
            },
            "actuation": {"strength": strength},
            "senses": {"touch": data.draw(st.none() | st.just({})), "vision": {"acuity": data.draw(acuity)}},
            "delays": {key: data.draw(delays_ms) for key in ("sensory_ms", "vision_ms", "motor_ms")},
            "control": {"timestep_ms": timestep_ms},
        }
    )
