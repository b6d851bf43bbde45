"""How an infant moves."""

from mimoc.quantities.quantity import Quantity

TERMS = "mimoc.quantities.run_motion"

HIP_PATH = Quantity(
    name="hip_path_m",
    label="Path of the hip",
    unit="m",
    about="length of the path of the hip",
    reduce="path",
    term=TERMS,
    steps=("run",),
)
HEAD_HEIGHT = Quantity(
    name="head_height_m",
    label="Largest height of the head",
    unit="m",
    about="largest height of the head's centre above z = 0",
    reduce="max",
    term=TERMS,
    steps=("run",),
)
HEAD_LOWEST = Quantity(
    name="head_lowest_m",
    label="Smallest height of the head",
    unit="m",
    about="smallest height of the head's centre above z = 0",
    reduce="min",
    term=TERMS,
    steps=("run",),
)
JOINT_SPEED = Quantity(
    name="joint_speed_rad_s",
    label="Joint speed",
    unit="rad/s",
    about="mean absolute joint velocity, over joints and control steps",
    term=TERMS,
    steps=("run",),
)
HAND_ERROR = Quantity(
    name="hand_error_m",
    label="Distance from hand to target after 1.5 s, median",
    unit="m",
    about="what the policy `reach` reports",
    steps=(),
)
FELL_AFTER = Quantity(
    name="fell_after_s",
    label="Too weak or too unsteady to sit unsupported: fell over after",
    unit="s",
    about="what policies that keep an infant sitting report",
    steps=(),
)
