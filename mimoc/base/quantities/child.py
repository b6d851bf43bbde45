"""What a child measures, in every step of a cohort, and quantities that only columns of tables show."""

from functools import partial

from mimoc.base.quantities.quantity import Quantity

_of_child = partial(Quantity, over="child", steps=("build", "check", "milestones", "run", "train", "python"))

LENGTH = _of_child("length_cm", "Length", "cm", "length from crown to sole")
WEIGHT = _of_child("mass_kg", "Weight", "kg", "mass of the whole body", field="weight_kg")
HEAD = _of_child("head_circumference_cm", "Head circumference", "cm", "largest circumference of the head")
ARM = _of_child("arm_circumference_cm", "Upper-arm circumference", "cm", "circumference at mid upper arm")
AGE = Quantity("age_months", "Age", "months", "age since birth", over="child", steps=())

CHILD = (LENGTH, WEIGHT, HEAD, ARM)
INDICATORS = {quantity.key: quantity for quantity in CHILD}
"""Quantities by the name of WHO's indicator, which is also the field of a manifest's child."""


PART_MASS = Quantity("mass_g", "Mass", "g")
BODY_SHARE = Quantity("share_of_body", "Share of the body", "%")
PEAK_TORQUE = Quantity("torque_nm", "Peak torque", "N m")
JOINT_RANGE = Quantity("range_deg", "Range", "°")
MEASURED = Quantity("measured_cm", "This infant", "cm")
AVERAGE = Quantity("average_cm", "Average child", "cm")
DIFFERENCE = Quantity("difference", "Difference", "%")
TOY_SIZE = Quantity("size_cm", "Longest side", "cm")
TOY_MASS = Quantity("weight_g", "Weight", "g")
FROM_AGE = Quantity("from_months", "From", "months")
MEAN_AGE = Quantity("mean_months", "Mean", "months")
JOB_TIME = Quantity("job_s", "A job", "s")
TIME_LEFT = Quantity("rest_h", "The rest", "h")
JOB_SIZE = Quantity("job_kb", "A job", "kB")
