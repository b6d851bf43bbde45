"""What an infant senses, how late, and with how much noise."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import mujoco

from mimoc.base.errors import RenderingError
from mimoc.bundle.io import Bundle
from mimoc.runtime.sense import bind_sense
from mimoc.schema.kinds import SENSES
from mimoc.schema.senses import MOTOR, noise_keys
from mimoc.studies.reporting import words
from mimoc.studies.reporting.page import Block, Cell, Section, TextBlock, table
from mimoc.studies.reporting.sources import Sources

SNELLEN_CPD = 600.0  # 20/20 is 30 cycles per degree, so 20/x is 600/x of them.
FELT = {
    "velocity": "how fast each turns",
    "torque": "the torques in its joints",
    "limits": "how near each is to the end of its range",
    "actuation": "how hard each is driven",
}
MOVED = {"accelerometer": "its acceleration (with gravity)", "gyro": "how fast it turns"}
NONE = "This infant has no senses: its observation is a single zero."
ABOUT = "Delays are whole physics steps of {step:g} ms; a control step takes {control:g} ms."


def senses(bundle: Bundle, model: mujoco.MjModel, sources: Sources) -> Section:
    """Return the section on an infant's senses, the commands to its muscles included."""
    manifest = bundle.manifest
    entries = {name: entry for name, entry in manifest.senses if entry is not None}
    rows = [
        [
            Cell(words.sentence(name)),
            Cell(_about(name, entry, bundle, model)),
            Cell(_observation(name, entry, bundle, model), "code"),
            _delay(name, bundle, sources),
            _noise(name, bundle, sources),
        ]
        for name, entry in entries.items()
    ]
    size = len(manifest.actuation.commands)
    share = manifest.noise.motor
    noisy = (
        Cell(f"SD {100 * share:.3g} % of the command", links=sources.links("noise.motor")) if share else Cell("none")
    )
    action = Cell(f"action: {size} numbers", "code")
    late = _delay(MOTOR, bundle, sources)
    rows.append([Cell("Commands"), Cell(_commands(bundle)), action, late, noisy])
    about = TextBlock(ABOUT.format(step=manifest.timestep_ms, control=manifest.step_ms))
    blocks: tuple[Block, ...] = (about, table(("", "what it gives", "observation", "delay", "noise"), rows))
    return Section("senses", "Senses and delays", blocks if entries else (TextBlock(NONE), *blocks))


def _about(name: str, entry: Any, bundle: Bundle, model: mujoco.MjModel) -> str:
    if name in ABOUT_SENSES:
        return ABOUT_SENSES[name](entry, model)
    lines = (SENSES[name].spec.__doc__ or "").strip().splitlines()
    return words.sentence(lines[0]) if lines else ""


def _about_proprioception(entry: Any, model: mujoco.MjModel) -> str:
    felt = [f"the angles of {len(entry.joints)} joints", *(FELT.get(signal, str(signal)) for signal in entry.include)]
    return f"Feels its own posture: {words.listed(felt)}."


def _about_balance(entry: Any, model: mujoco.MjModel) -> str:
    return (
        f"Feels how its head moves: {words.listed([about for name, about in MOVED.items() if getattr(entry, name)])}."
    )


def _about_touch(entry: Any, model: mujoco.MjModel) -> str:
    skin = [part for part in entry.skin if part.points]
    total = sum(part.points for part in skin)
    if not skin:
        return "Has no skin points."
    finest, coarsest = min(skin, key=lambda s: s.spacing_m), max(skin, key=lambda s: s.spacing_m)
    felt = "how hard it is pressed" if entry.quantity == "normal" else "the force, with its direction"
    spread = f"from {1000 * finest.spacing_m:.1f} mm apart ({words.name(finest.body)})"
    ends = f"to {1000 * coarsest.spacing_m:.1f} mm ({words.name(coarsest.body)})"
    return f"Feels {felt}, at {total:,} points of its skin, {spread} {ends}."


def _about_vision(entry: Any, model: mujoco.MjModel) -> str:
    fovy_deg = float(model.camera(entry.cameras[0]).fovy[0]) if entry.cameras else 0.0
    seen = f"{entry.width_px} {words.TIMES} {entry.height_px} pixels over {fovy_deg:g}° from top to bottom"
    sharp = "as sharp as its pixels are"
    if entry.acuity_cpd:
        snellen = f"about 20/{SNELLEN_CPD / entry.acuity_cpd:.0f}; adults: 20/20"
        sharp = f"so sharp that it can just tell {entry.acuity_cpd:.2g} stripes in a degree ({snellen})"
    fovea = ", sharpest in the middle" if entry.foveation else ""
    eyes = words.count(len(entry.cameras), "eye")
    return " ".join((f"Sees with {eyes}: {seen}, {sharp}{fovea}.", *_immaturities(entry)))


def _immaturities(entry: Any) -> Iterator[str]:
    if entry.sensitivity:
        yield (
            f"Sees contrasts from {100 / entry.sensitivity:.2g} % on, at {entry.sensitivity_peak_cpd:.2g} stripes in a "
            "degree."
        )
    if entry.purity_threshold is not None:
        share = f"{100 * entry.chroma_gain:.0f} % as strong"
        yield f"Sees colours of a purity from {100 * entry.purity_threshold:.2g} % on, {share}."
    if entry.noticed_deg is not None:
        yield f"Notices what is within {entry.noticed_deg:.0f}° of where it looks."
    if entry.unfocused:
        yield "Is focused on what is at 25 cm."
    if entry.flicker_hz is not None:
        yield f"Sees changes of up to {entry.flicker_hz:.2g} Hz."


ABOUT_SENSES: Mapping[str, Callable[[Any, mujoco.MjModel], str]] = {
    "proprioception": _about_proprioception,
    "vestibular": _about_balance,
    "touch": _about_touch,
    "vision": _about_vision,
}
"""Descriptions of mimoc's own senses; others are described by the first line of their help."""


def _observation(name: str, entry: Any, bundle: Bundle, model: mujoco.MjModel) -> str:
    times = f" {words.TIMES} "
    if name == "vision":  # To be known without OpenGL as well.
        shape = f"{entry.height_px}{times}{entry.width_px}{times}3"
        return ", ".join(f"{camera}: {shape}" for camera in entry.cameras)
    try:
        sense = bind_sense(name, bundle, model)
    except RenderingError:
        return ""
    sense.close()
    return ", ".join(f"{key}: {times.join(map(str, space.shape or ()))} numbers" for key, space in sense.spaces.items())


def _delay(signal: str, bundle: Bundle, sources: Sources) -> Cell:
    delay = getattr(bundle.manifest.delays, signal)
    way = "to" if signal == MOTOR else "from"
    legs = f", {delay.legs_ms:g} ms {way} the legs" if delay.legs_ms is not None else ""
    jitter_ms = bundle.manifest.noise.delay_jitter_ms
    jitter = f", ± {jitter_ms:g} ms" if jitter_ms and (delay.ms or delay.legs_ms) else ""
    text = f"{delay.ms:g} ms{legs}{jitter}" if delay.ms or delay.legs_ms else "none"
    return Cell(text, links=sources.links(f"delays.{signal}.ms"))


def _noise(name: str, bundle: Bundle, sources: Sources) -> Cell:
    key = noise_keys().get(name)
    amount = getattr(bundle.manifest.noise, key) if key else 0
    if not key or not amount:
        return Cell("none")
    kind = SENSES[name].noise
    unit = {"deg": "°", "n": " N"}.get(kind.unit, f" {kind.unit}") if kind else ""
    return Cell(f"SD {amount:g}{unit}", links=sources.links(f"noise.{key}"))


def _commands(bundle: Bundle) -> str:
    actuation = bundle.manifest.actuation
    joints = len({actuator.joint for actuator in actuation.actuators})
    how = {
        "torque": f"Torques at {joints} joints, as a share of their peak.",
        "muscle": f"How hard each muscle pulls: two at each of {joints} joints.",
        "position": f"The angle that each of {joints} joints is to take.",
    }
    return how.get(actuation.model, f"Commands to the actuators of {joints} joints ({actuation.model}).")
