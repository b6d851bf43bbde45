"""What a companion is, and the companions of one infant: they act before each physics step and see what comes of it.

    time   0            1            2            physics steps
           |before_step |before_step |before_step
           |            |after_step  |after_step
           reset

Before each physics step, `before_step` moves bodies, and after it, `after_step` sees the state. With a companion, a
control step is cut at every physics step; without any, nothing is done.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.base.errors import KindError
from mimoc.base.kinds import check_custom_object, function_of
from mimoc.bundle.model import physics_of
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.sense import NOTHING, FloatArray, Sense
from mimoc.runtime.sound import Sound, SoundSources, Voice
from mimoc.schema.kinds import COMPANIONS, OBJECTS


class Companion:
    """Something that acts in the world of an infant; this one does nothing.

    A script passes its own by name: `mimoc.make(spec, companions={"wind": Wind()})`. It moves bodies by what belongs to
    the state of a simulation, `mocap_pos`, `mocap_quat`, `xfrc_applied` or `ctrl`, or by `model_fields`.

    Example:
        >>> import mimoc
        >>> class Wind(mimoc.Companion):
        ...     def bind(self, model, bundle, generator):
        ...         self.root = model.body(bundle.manifest.root_body).id
        ...     def before_step(self, data):
        ...         data.xfrc_applied[self.root, 0] = 2.0
        >>> env = mimoc.make("nine_months.yaml", companions={"wind": Wind()})
        >>> _ = env.reset(seed=0)
        >>> _ = env.step(0 * env.action_space.sample())
    """

    model_fields: Sequence[ModelField] = ()
    """What it changes in the model, once it is bound; all else in the model must stay as it is."""
    attends_to_all: bool = False
    """Whether there is one for all infants of a world, bound with the first of them, which hears each of them apart."""
    orders: Sequence[Mapping[str, Any]] = ()
    """What a script has asked it to do and has not begun, as plain data: recordings keep it, and give it back."""

    def bind(self, model: mujoco.MjModel, bundle: Any, generator: np.random.Generator) -> None:
        """Look up names in a model: at the start, and whenever the infant has another one.

        Args:
            model: The infant and its world.
            bundle: The `mimoc.Bundle` it comes from; `bundle.manifest` names what is in it.
            generator: Source of all random numbers of this companion, whose state is part of the environment's.
        """

    def reset(self, data: mujoco.MjData) -> None:
        """Start an episode, when the infant is in its pose and its task has started.

        Args:
            data: The state, with all that follows from it. Whoever changes it calls `mj_forward` afterwards.
        """

    def before_step(self, data: mujoco.MjData) -> None:
        """Act in the physics step that is about to be made; commands that arrive now are in `data.ctrl` already."""

    def after_step(self, data: mujoco.MjData) -> None:
        """See the state after a physics step.

        Positions of bodies and contacts are those from which the step was made, as MuJoCo leaves them; `time`, `qpos`
        and `qvel` are those after it.
        """

    def obey(self, order: Mapping[str, Any]) -> None:
        """Take one of `orders`, as it was recorded."""
        self.orders = [*self.orders, dict(order)]

    def listen_to(self, sources: SoundSources, voice: Voice | None = None, others: Sequence[Voice] = ()) -> None:
        """Hear these sources from now on, which include itself, besides the infant's voice and those of others."""
        return

    def listen_to_infants(self, voices: Mapping[str, tuple[SoundSources, Voice | None]]) -> None:
        """Hear several infants from now on: by name, the sounds of its companions, and its voice."""
        return

    def sounds(self, data: mujoco.MjData) -> Sequence[Sound]:
        """Return its sounds that last or ended within `SILENT_AFTER_MS`."""
        return ()

    @property
    def state(self) -> dict[str, Any]:
        """All that it remembers within an episode and is not in `data`, to be copied and pickled; it can be set."""
        return {}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        return


class Companions(Mapping[str, Companion]):
    """The companions of one infant, by name."""

    def __init__(
        self,
        companions: Mapping[str, Companion],
        streams: NoiseStreams,
        of_senses: Mapping[str, Companion] = NOTHING,
        custom: Collection[str] = (),
    ):
        """Keep companions that are bound to the infant's model, and draw from the streams of its environment.

        Those of senses, by the name of the sense, see each physics step after all others; they are part of the infant.
        """
        self._companions, self._streams = dict(companions), streams
        self.custom = frozenset(custom)  # Names of those that a script has passed and the bundle alone does not give.
        self._all = {**companions, **{f"senses.{name}": companion for name, companion in of_senses.items()}}
        self.before: FloatArray = np.zeros(0)  # MuJoCo's state before the last physics step, shape (n,), or (0,).

    def __getitem__(self, name: str) -> Companion:
        return self._companions[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._companions)

    def __len__(self) -> int:
        return len(self._companions)

    def __bool__(self) -> bool:
        return bool(self._all)

    @property
    def model_fields(self) -> list[ModelField]:
        """What they change in the model."""
        return [field for companion in self._companions.values() for field in companion.model_fields]

    def reset(self, data: mujoco.MjData) -> None:
        """Start an episode of all of them; their streams restart if those of the environment have."""
        for name in self._companions:
            _ = self._streams[channel_of(name)]
        self.before = np.zeros(0)
        for companion in self._all.values():
            companion.reset(data)

    def before_step(self, data: mujoco.MjData) -> None:
        """Let them act before a physics step."""
        for companion in self._all.values():
            companion.before_step(data)
        if self._companions:  # They see bodies and contacts of the step before: a state must lead to these as well.
            self.before = physics_of(data.model, data)

    def after_step(self, data: mujoco.MjData) -> None:
        """Let them see the state after a physics step."""
        for companion in self._all.values():
            companion.after_step(data)

    def sounds(self, data: mujoco.MjData) -> list[Sound]:
        """Return their sounds that can still be heard."""
        return [sound for companion in self._companions.values() for sound in companion.sounds(data)]

    @property
    def state(self) -> dict[str, Any]:
        """What each remembers within an episode."""
        return {name: companion.state for name, companion in self._all.items()}

    @state.setter
    def state(self, state: Mapping[str, Any]) -> None:
        for name, companion in self._all.items():
            companion.state = state[name]


class SoundsOf:
    """The sounds of the companions of several infants."""

    def __init__(self, sources: Sequence[SoundSources]):
        self._sources = sources

    def sounds(self, data: mujoco.MjData) -> list[Sound]:
        """Return the sounds of all that can still be heard."""
        return [sound for source in self._sources for sound in source.sounds(data)]


def channel_of(name: str) -> str:
    """Return the name of the random stream of a companion."""
    return f"companion.{name}"


def bind_companions(
    model: mujoco.MjModel,
    bundle: Any,
    streams: NoiseStreams,
    custom: Mapping[str, Companion],
    senses: Mapping[str, Sense] = NOTHING,
    voice: Voice | None = None,
    world: Any = None,
) -> Companions:
    """Return the companions of an infant, bound to its model.

    What acts on several infants, a caregiver and water, is bound once, with the first of them.
    """
    whole = world if bundle.manifest.prefix else bundle
    present = [name for name in COMPANIONS if whole and getattr(whole.manifest, name)]
    companions: dict[str, Companion] = {name: function_of(COMPANIONS[name], "bind")() for name in present}
    for name, companion in custom.items():
        check_custom_object(f"companion '{name}'", companion, "before_step", "an object such as a mimoc.Companion")
        if not isinstance(companion, Companion):
            raise KindError(f"companion '{name}' is {companion!r:.60}; pass an object of a subclass of mimoc.Companion")
        if not whole and companion.attends_to_all:
            raise KindError(f"companion '{name}': a world has one caregiver; pass it with the first infant")
    own = {name for name, companion in custom.items() if type(companion) is not type(companions.get(name))}
    companions |= custom
    objects = whole.manifest.objects if whole else ()
    kinds = sorted({item.kind for item in objects} & OBJECTS.keys() - custom.keys())
    acting = {name: code for name in kinds if (code := OBJECTS[name].run)}
    companions |= {name: function_of(code, "bind")() for name, code in acting.items()}  # They see what others apply.
    for name, companion in companions.items():
        is_shared = name in acting or companion.attends_to_all
        companion.bind(model, whole if is_shared else bundle, streams[channel_of(name)])
    bound = Companions(
        companions, streams, {name: sense.companion for name, sense in senses.items() if sense.companion}, own
    )
    for listener in (*companions.values(), *senses.values()):
        listener.listen_to(bound, voice)
    return bound


def hear_each_other(infants: Mapping[str, Any]) -> None:
    """Let the infants of a world hear each other and all companions, and a caregiver hear all infants."""
    everywhere = SoundsOf([infant.companions for infant in infants.values()])
    for name, infant in infants.items():
        others = [other.voice for key, other in infants.items() if key != name and other.voice]
        for sense in infant.senses.values():
            sense.listen_to(everywhere, infant.voice, others)
        for companion in infant.companions.values():
            if companion.attends_to_all:
                companion.listen_to_infants({key: (one.companions, one.voice) for key, one in infants.items()})
            else:
                companion.listen_to(everywhere, infant.voice, others)
