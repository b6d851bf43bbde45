"""The `control` of a spec: duration of physics steps and of control steps."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from mimoc.schema.base import KeyedError, Model
from mimoc.schema.quantities import Milliseconds
from mimoc.units import to_steps


class ControlSpec(Model):
    """Duration of physics steps and of control steps."""

    step_ms: Annotated[Milliseconds, Field(ge=0.1, le=1000)] = 10.0
    """Duration of a control step, a whole number of physics steps; by default that of the task, or 10 ms."""
    timestep_ms: Annotated[Milliseconds, Field(ge=0.1, le=20)] = 5.0
    """Duration of a physics step."""

    def with_default_step(self, step_ms: float) -> Self:
        """Return this section with another control step, which is treated as a default.

        Raises:
            KeyedError: If that is not a whole number of physics steps.
        """
        clock = self.model_construct(self.model_fields_set, step_ms=step_ms, timestep_ms=self.timestep_ms)
        clock.check_steps()
        return clock

    def check_steps(self) -> None:
        """Check that the control step is a whole number of physics steps.

        Raises:
            KeyedError: If it is not.
        """
        keys = ("step_ms", "timestep_ms") if "step_ms" in self.model_fields_set else ("timestep_ms", "step_ms")
        try:
            if self.step_ms < self.timestep_ms:
                advice = f"give 'step_ms' {self.timestep_ms:g} or more"
                raise ValueError(
                    f"{self.step_ms:g} ms is less than a physics step of {self.timestep_ms:g} ms; {advice}"
                )
            to_steps(self.step_ms, self.timestep_ms)
        except ValueError as error:
            raise KeyedError(keys[:1], f"a control step of {error}", against=keys[1:]) from None

    @model_validator(mode="after")
    def _steps_fit(self) -> Self:
        self.check_steps()
        return self
