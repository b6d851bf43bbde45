"""What a child measures, which is the same in every step of a cohort."""

from functools import partial

from mimoc.quantities.quantity import Quantity

_of_child = partial(Quantity, over="child", steps=("build", "check", "run", "train", "python"))

LENGTH = _of_child("length_cm", "Length", "cm", "length from crown to sole")
WEIGHT = _of_child("mass_kg", "Weight", "kg", "mass of the whole body", field="weight_kg")
HEAD = _of_child("head_circumference_cm", "Head circumference", "cm", "largest circumference of the head")
ARM = _of_child("arm_circumference_cm", "Upper-arm circumference", "cm", "circumference at mid upper arm")
AGE = Quantity("age_months", "Age", "months", "age since birth", over="child", steps=())

CHILD = (LENGTH, WEIGHT, HEAD, ARM)
INDICATORS = {quantity.key: quantity for quantity in CHILD}
"""Quantities by the name of WHO's indicator, which is also the field of a manifest's child."""
