"""Quantities that only columns of tables show."""

from mimoc.quantities.quantity import Quantity

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
JOB_TIME = Quantity("job_s", "A job", "s")
TIME_LEFT = Quantity("rest_h", "The rest", "h")
JOB_SIZE = Quantity("job_kb", "A job", "kB")
