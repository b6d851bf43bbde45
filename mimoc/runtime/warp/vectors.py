"""Proprioception and the vestibular sense on a device: each number is a field of the simulation at some place."""

from collections.abc import Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp

from mimoc.errors import MimocError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import flat, put
from mimoc.senses.proprioception.run import LIMIT_MARGIN_RAD
from mimoc.senses.sense import FloatArray

QPOS, QVEL, SENSOR, CTRL, ACT, FORCE, LIMIT = range(7)
"""What a number is read from; what is no plain field is computed with the constants of the infant."""

Columns = tuple[list[int], list[int], list[float], list[float]]


class VectorReader:
    """Reads one sense of all infants."""

    def __init__(self, name: str, infants: Sequence[InfantEnv], body_of_world: wp.array):
        """Find what it reads.

        Args:
            name: `proprioception` or `vestibular`.
            infants: The different bodies.
            body_of_world: Which of them lives in each world.
        """
        found = [READS[name](infant) for infant in infants]
        sources, places, *_ = found[0]
        self._sources, self._places = put(sources, wp.int32), put(places, wp.int32)
        self._first, self._second = (put([each[index] for each in found]) for index in (2, 3))
        self._body = body_of_world

    def __call__(self, model: mjw.Model, data: mjw.Data, sample: wp.array) -> None:
        """Write what is sensed now, shape (worlds, n)."""
        fields = [data.qpos, data.qvel, data.sensordata, data.ctrl, data.act, data.actuator_force]
        constants = [self._body, self._sources, self._places, self._first, self._second]
        wp.launch(_read, sample.shape, [*constants, *map(flat, fields)], [sample])


def proprioception(infant: InfantEnv) -> Columns:
    """Return for each number what it is read from, where, and two constants."""
    entry: Any = infant.manifest.senses.proprioception
    sense: Any = infant.senses["proprioception"]
    sources: list[int] = []
    places: list[int] = []
    constants: list[FloatArray] = []
    for name, component in zip(("angle", *entry.include), sense.components, strict=True):
        source, count = _sources(name, infant), len(component.addresses)
        sources += np.repeat(source, count).tolist()
        places += (_activations(infant) if source[0] == ACT else component.addresses).tolist()
        places += component.addresses.tolist() * (len(source) - 1)
        constants += [np.zeros((2, count))] * (len(source) - len(component.constants[:1]))
        if component.constants:
            constants.append(np.stack([*component.constants, np.zeros(count)][:2]))
    first, second = np.concatenate(constants, axis=1)
    return sources, places, first.tolist(), second.tolist()


def vestibular(infant: InfantEnv) -> Columns:
    """Return the same of the vestibular sense."""
    sense: Any = infant.senses["vestibular"]
    places = list(sense.expression)
    return [SENSOR] * len(places), places, [0.0] * len(places), [0.0] * len(places)


READS = {"proprioception": proprioception, "vestibular": vestibular}
"""Senses that are read by one kernel."""


def _sources(component: str, infant: InfantEnv) -> list[int]:
    """Return what a component of proprioception is read from; that of actuators is two, one after the other."""
    plain = {"angle": QPOS, "velocity": QVEL, "torque": SENSOR, "limits": LIMIT}
    if component in plain:
        return [plain[component]]
    if component != "actuation":
        raise MimocError(f"proprioception of '{component}' is not there on this device; leave it out, or use the CPU")
    return [ACT if infant.actuation.drive_name == "activation" else CTRL, FORCE]


def _activations(infant: InfantEnv) -> Any:
    """Return the place of the activation of each actuator, in the order of the manifest."""
    names = [actuator.name for actuator in infant.manifest.actuation.actuators]
    return np.array([infant.model.actuator(name).actadr[0] for name in names])


@wp.kernel(enable_backward=False)
def _read(
    body: wp.array[int],
    sources: wp.array[int],
    places: wp.array[int],
    first: wp.array2d[float],
    second: wp.array2d[float],
    qpos: wp.array2d[float],
    qvel: wp.array2d[float],
    sensordata: wp.array2d[float],
    ctrl: wp.array2d[float],
    act: wp.array2d[float],
    force: wp.array2d[float],
    sample: wp.array2d[float],
):
    world, number = wp.tid()
    source = sources[number]
    place = places[number]
    value = float(0.0)
    if source == wp.static(QPOS):
        value = qpos[world, place]
    elif source == wp.static(QVEL):
        value = qvel[world, place]
    elif source == wp.static(SENSOR):
        value = sensordata[world, place]
    elif source == wp.static(CTRL):
        value = ctrl[world, place]
    elif source == wp.static(ACT):
        value = act[world, place]
    elif source == wp.static(FORCE):
        value = force[world, place] * first[body[world], number]
    else:
        beyond = wp.abs(qpos[world, place] - first[body[world], number]) - second[body[world], number]
        value = wp.max(beyond, 0.0) / wp.static(LIMIT_MARGIN_RAD)
    sample[world, number] = value
