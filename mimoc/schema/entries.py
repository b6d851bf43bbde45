"""Types of what stands in a manifest: names of things in the model, and numbers in bounds.

A bundle may come from anyone. Each number has the widest range that any infant can need, and each name says what it
names, so that all are looked up in the model before anything runs.
"""

from dataclasses import dataclass
from typing import Annotated, TypeAlias

from pydantic import Field, StringConstraints


@dataclass(frozen=True, slots=True)
class NameOf:
    """Marks a field, in its annotation, as the name of something in the model."""

    kind: str
    """What it names, such as `hinge`; a `lock` is an equality constraint on a joint, and a `weld` one on two bodies."""


Label = Annotated[str, StringConstraints(max_length=1000)]  # A text that is only shown.

Body = Annotated[Label, NameOf("body")]
Hinge = Annotated[Label, NameOf("hinge")]
FreeJoint = Annotated[Label, NameOf("free joint")]
Joint = Annotated[Label, NameOf("joint")]
Tendon = Annotated[Label, NameOf("tendon")]
Geom = Annotated[Label, NameOf("geom")]
Sensor = Annotated[Label, NameOf("sensor of three numbers")]
Actuator = Annotated[Label, NameOf("actuator")]
Camera = Annotated[Label, NameOf("camera")]
Keyframe = Annotated[Label, NameOf("keyframe")]
Material = Annotated[Label, NameOf("material")]
Skin = Annotated[Label, NameOf("skin")]
LockName = Annotated[Label, NameOf("lock")]
WeldName = Annotated[Label, NameOf("weld")]

Number = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]  # Any number, such as a reward.
Amount = Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)]  # A number that is not negative, such as a weight.
Length = Annotated[float, Field(gt=0, le=100, allow_inf_nan=False)]  # A length, in [m].
Duration = Annotated[float, Field(ge=0, le=10_000, allow_inf_nan=False)]  # A delay, or a time constant, in [ms].
ControlStep = Annotated[Duration, Field(ge=0.1, le=1000)]  # Duration of a control step, in [ms].
Count = Annotated[int, Field(ge=0)]  # A number of things, or the index of a thing, from 0.
Size = Annotated[int, Field(ge=1)]  # A number of things of which there is at least one.
Digest = Annotated[str, StringConstraints(pattern="^sha256:[0-9a-f]{64}$")]  # Digest of a bundle.
Steps = Annotated[int, Field(ge=1, le=10**9)]  # Control steps.
Lengths: TypeAlias = tuple[Length, Length]  # Lowest and highest length, in [m].
Numbers: TypeAlias = tuple[Number, Number]  # Lowest and highest number.
