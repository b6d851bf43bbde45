"""Torque on a spring and damper at each joint."""

from mimoc.base.kinds import ActuationKind

KIND = ActuationKind(
    name="torque",
    about="Torque on a spring and damper at each joint.",
    build="mimoc.actuation.torque.build",
    run="mimoc.actuation.torque.run",
)
