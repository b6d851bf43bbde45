"""The `senses` of a spec and of a manifest, and their delays and noise, with those of the commands."""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, TypeAlias, cast

from pydantic import Discriminator, Field, Tag
from pydantic.fields import FieldInfo

from mimoc.base.errors import KindError
from mimoc.base.units import to_steps
from mimoc.schema.base import ComposedModel, KeyedError, Model, composed, described_field, omitting, section_field
from mimoc.schema.entries import Amount, Body, Duration
from mimoc.schema.kinds import ACTUATIONS, SENSES
from mimoc.schema.quantities import Milliseconds, Real


@composed(lambda: {kind.name: section_field(kind.spec) for kind in SENSES.values()})
class SensesSpec(ComposedModel):
    """The senses of the infant; a sense that is not listed is off."""


@composed(lambda: {kind.name: section_field(kind.entry) for kind in SENSES.values()})
class SensesEntry(ComposedModel):
    """The senses of the infant; a sense that is None is off."""


Delay = Annotated[Milliseconds, Field(le=10_000)]
MOTOR = "motor"  # The signal to the actuators; all others come from senses.


def signals() -> tuple[str, ...]:
    """Return the names of all signals that can be delayed: those of the senses, then `motor`."""
    if MOTOR in SENSES:
        raise KindError(f"'{MOTOR}' is already the name of commands among the delays; choose another name")
    return (*SENSES, MOTOR)


def _delay_fields() -> dict[str, FieldInfo]:
    about = {name: f"Delay of {name}." for name in SENSES} | {MOTOR: "Delay from command to actuator."}
    return {f"{name}_ms": described_field(Delay | None, None, about[name]) for name in signals()}


@composed(_delay_fields)
class DelaysSpec(ComposedModel):
    """Sensory and motor delays, each a multiple of the physics step; the more specific key takes precedence."""

    preset: Literal["none", "paper", "physiological"] = "none"
    """Delays that apply where none is given: zero (`none`), those of the paper (`paper`), or those of an infant of this
    age (`physiological`)."""
    sensory_ms: Delay | None = None
    """Delay of every sense for which no delay is given below."""
    processing: Literal["off", "age", "adult"] | None = None
    """Time that behaviours take to decide besides conduction: none (`off`, the default), that of the infant's age
    (`age`), or of adults (`adult`)."""


def given_keys(spec: DelaysSpec, signal: str) -> list[str]:
    """Return the keys of a spec that give the delay of a signal; the first takes precedence."""
    common = () if signal == MOTOR else ("sensory_ms",)
    return [key for key in (f"{signal}_ms", *common) if getattr(spec, key) is not None]


def is_delayed(spec: DelaysSpec, senses: Iterable[str]) -> bool:
    """Return whether the commands or one of some senses can have a delay."""
    for signal in (*senses, MOTOR):
        keys = given_keys(spec, signal)
        if getattr(spec, keys[0]) if keys else spec.preset != "none":
            return True
    return False


class PartDelay(Model):
    """Delay of one signal to or from a part of the body."""

    body: Body
    """The first body of the part."""
    ms: Duration
    """Delay."""


class DelayEntry(Model):
    """Delay of one signal, in whole physics steps."""

    ms: Duration = 0.0
    """Delay."""
    legs_ms: Duration | None = None
    """Delay to or from legs and feet, if it differs."""
    parts: tuple[PartDelay, ...] = ()
    """Delays to or from other parts, if they differ; later ones may be in earlier ones."""

    _serialized = omitting("parts")


class ProcessingEntry(Model):
    """How long decisions take, besides conduction."""

    look_ms: Duration
    """Mean decision to look at a new target."""
    reach_ms: Duration
    """Mean decision to reach for a new target."""
    look_variation: Annotated[float, Field(ge=0, le=10)]
    """Standard deviation of a decision to look, as a share of its mean."""
    reach_variation: Annotated[float, Field(ge=0, le=10)]
    """Standard deviation of a decision to reach, as a share of its mean."""


@composed(lambda: {name: described_field(DelayEntry, DelayEntry(), f"Delay of {name}.") for name in signals()})
class DelaysEntry(ComposedModel):
    """The delay of each signal."""

    legs: tuple[Body, ...] = ()
    """The first body of each leg."""
    processing: ProcessingEntry | None = None
    """How long decisions of behaviours take; None is no time."""

    _serialized = omitting("processing")


LOW_PASS_MS = 60.0
"""Time constant of the noise of commands and of proprioception: as long as the muscles of infants are assumed to take
(derived, for want of a measurement; half-relaxation takes 90 ms at 3 years and 40 ms at 10, Lin et al. 1994)."""


def _kind_of_amount(value: Any) -> str | None:
    if isinstance(value, str):
        return "word" if value.isalpha() else None
    return "number" if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def _discriminated(wanted: str) -> tuple[Any, ...]:
    """Return what tells numbers from words, and what errors ask for."""
    return Discriminator(_kind_of_amount), Field(json_schema_extra={"wanted": wanted})


MotorNoise: TypeAlias = Annotated[
    Annotated[Literal["maturing"], Tag("word")] | Annotated[Annotated[Real, Field(ge=0, le=1)], Tag("number")],
    *_discriminated("a share of the command; write a number from 0 to 1, or maturing"),
]
"""A share of the command, or that of the infant's age."""


def noise_keys() -> dict[str, str]:
    """Return the key of each sense that can be noisy, such as `proprioception_deg`."""
    return {kind.name: f"{kind.name}_{kind.noise.unit}" for kind in SENSES.values() if kind.noise}


def _spec_fields() -> dict[str, FieldInfo]:
    fields = {}
    word = cast(Any, Annotated[Literal["age", "adult"], Tag("word")])
    for name, key in noise_keys().items():
        noise: Any = SENSES[name].noise
        amount: Any = Annotated[Real, Field(ge=0, le=noise.most, json_schema_extra={"unit": noise.unit})]
        if noise.by_age:
            wanted = f"an amount of noise; write a number from 0 to {noise.most:g}, age or adult"
            amount = Annotated[word | Annotated[amount, Tag("number")], *_discriminated(wanted)]
        if noise.omit_if_absent:
            amount = amount | None
        fields[key] = described_field(amount, None if noise.omit_if_absent else 0.0, noise.about)
    return fields


def _recent_keys() -> list[str]:
    """Return the keys of recent senses and noise, which are left out where they say nothing."""
    kinds = {key: SENSES[name] for name, key in noise_keys().items()}
    return [key for key, kind in kinds.items() if kind.noise and (kind.omit_if_absent or kind.noise.omit_if_absent)]


def low_pass_key(sense: str) -> str:
    """Return the key of the time constant of the noise of a sense, where it has one of its own."""
    return f"{sense}_low_pass_ms"


def _entry_fields() -> dict[str, FieldInfo]:
    fields = {key: described_field(Amount, 0.0, f"Noise of {name}.") for name, key in noise_keys().items()}
    for kind in SENSES.values():
        if kind.noise and kind.noise.low_pass_ms:
            about = f"Time constant of the noise of {kind.name}, if it differs."
            time = cast(Any, Annotated[Duration, Field(ge=0.1)])
            fields[low_pass_key(kind.name)] = described_field(time | None, None, about)
    return fields


@composed(_spec_fields)
class NoiseSpec(ComposedModel):
    """Noise of the commands and the senses, and jitter of their delays; 0 is none."""

    motor: MotorNoise = 0.0
    """Standard deviation of what an actuator is driven by, as a share of its command, or that of the infant's age
    (`maturing`: .30 at birth, .10 from 18 months on); it changes with a time constant of 60 ms."""
    delay_jitter_ms: Annotated[Milliseconds, Field(le=1000)] = 0.0
    """Largest deviation of a delay from its value, a multiple of the physics step; a delay that is shorter deviates by
    no more than itself."""

    _serialized = omitting(*_recent_keys())


@composed(_entry_fields)
class NoiseEntry(ComposedModel):
    """The noise of commands, senses and delays; 0 is none."""

    motor: Annotated[Amount, Field(le=1)] = 0.0
    """Standard deviation of what an actuator is driven by, as a share of its command."""
    of_commands: tuple[Annotated[Amount, Field(le=1)], ...] = ()
    """The same of each number of the action, if they differ."""
    low_pass_ms: Annotated[Duration, Field(ge=0.1)] = LOW_PASS_MS
    """Time constant of the noise of commands and of senses whose noise changes gradually."""
    delay_jitter_ms: Annotated[Duration, Field(le=1000)] = 0.0
    """Largest deviation of a delay, in whole physics steps."""

    _serialized = omitting("of_commands", "proprioception_low_pass_ms", *_recent_keys())


def check_noise(
    noise: NoiseSpec, senses: Mapping[str, Any], delays: DelaysSpec, actuation: str, timestep_ms: float
) -> None:
    """Check that there is something for each noise to act on; the section of a sense is None if it is off.

    Raises:
        KeyedError: If a sense is off, nothing has a delay, or the actuation model has no such noise.
    """
    if noise.motor and not ACTUATIONS[actuation].command_is_effort:
        able = " or ".join(kind.name for kind in ACTUATIONS.values() if kind.command_is_effort)
        message = (
            f"is in proportion to effort, which a command to '{actuation}' actuators does not say; "
            f"remove it, or set actuation.model to {able}"
        )
        raise KeyedError(("noise", "motor"), message, against=("actuation", "model"))
    for name, key in noise_keys().items():
        if getattr(noise, key) and senses.get(name) is None:
            message = f"'{name}' is off, so it has no noise; add '{name}: {{}}' to the senses, or remove this"
            raise KeyedError(("noise", key), message, against=("senses", name))
    if noise.delay_jitter_ms:
        _check_jitter(noise.delay_jitter_ms, senses, delays, timestep_ms)


def _check_jitter(jitter_ms: float, senses: Mapping[str, Any], delays: DelaysSpec, timestep_ms: float) -> None:
    key = ("noise", "delay_jitter_ms")
    try:
        to_steps(jitter_ms, timestep_ms)
    except ValueError as error:
        raise KeyedError(key, f"a jitter of {error}", against=("control", "timestep_ms")) from None
    if not is_delayed(delays, [name for name, section in senses.items() if section is not None]):
        message = "no delay varies, because there is none; add delays, such as 'preset: physiological', or remove this"
        raise KeyedError(key, message, against=("delays",))
