"""What a child measures, which is the same in every step of a cohort."""

from mimoc.quantities.quantity import Quantity

EVERY_STEP = ("build", "check", "run", "train", "python")
"""Steps of a cohort that have an infant."""


def _of_child(name: str, label: str, unit: str, about: str, field: str = "") -> Quantity:
    return Quantity(name, label, unit, about, over="child", field=field or name, steps=EVERY_STEP)


LENGTH = _of_child("length_cm", "Length", "cm", "length from crown to sole")
WEIGHT = _of_child("mass_kg", "Weight", "kg", "mass of the whole body", field="weight_kg")
HEAD = _of_child("head_circumference_cm", "Head circumference", "cm", "largest circumference of the head")
ARM = _of_child("arm_circumference_cm", "Upper-arm circumference", "cm", "circumference at mid upper arm")
AGE = Quantity("age_months", "Age", "months", "age since birth", over="child", field="age_months", steps=())

CHILD = (LENGTH, WEIGHT, HEAD, ARM)
INDICATORS = {quantity.field: quantity for quantity in CHILD}
"""Quantities by the name of WHO's indicator, which is also the field of a manifest's child."""
