import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.base.units import m_to_cm
from mimoc.body.grow import grow_tree
from mimoc.body.kinematics import stature
from mimoc.fits import load_tables, measure

MITTEN = assemble("mitten", False)


def test_a_body_measures_what_its_measurements_say(infants):
    """As WHO would measure the compiled model: crown to sole, mass, head, left arm."""
    for infant in infants:
        child, found = (
            measure(infant.age_months),
            stature(grow_tree(measure(infant.age_months), assemble(infant.hands, False))),
        )
        assert found["length_cm"] == pytest.approx(m_to_cm(child["crown_sole_length"]), abs=0.2)
        assert found["weight_kg"] == pytest.approx(infant.model.body("hip").subtreemass[0], rel=1e-8)
        assert found["head_circumference_cm"] == pytest.approx(m_to_cm(child["head_circumference"]))
        assert found["arm_circumference_cm"] == pytest.approx(m_to_cm(child["upper_arm_circumference"]))


def test_what_is_measured_is_what_who_has_standards_for():
    assert stature(grow_tree(measure(9), MITTEN)).keys() == load_tables().who.keys()
