"""Torque on a spring and damper at each joint."""

from mimoc.schema.kinds import ActuationKind

KIND = ActuationKind(
    name="torque",
    about="Torque on a spring and damper at each joint.",
    build="mimoc.components.actuation.torque.build",
    run="mimoc.components.actuation.torque.run",
)
