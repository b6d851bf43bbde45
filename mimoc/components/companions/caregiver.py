"""A caregiver in a simulation: acts by its script, answers the infant, and does what it is asked to."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.base.errors import MimocError, UnknownNameError, check_name
from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.units import to_steps
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.world import WorldManifest, manifests_of
from mimoc.components.companions.body import CaregiverBody, Infant
from mimoc.components.companions.hands import Hands, Offered
from mimoc.runtime.companion import Companion
from mimoc.runtime.sound import SILENT_AFTER_MS, Sound, SoundSources, Voice, step_of
from mimoc.schema.caregiver import ACTS, CaregiverEntry

NAME = "caregiver"
SMILE_MS = 1500.0  # How long it smiles unless an act says otherwise; an assumption.
VOICE_MS = 400.0  # How long it speaks unless an act says otherwise; an assumption.
PITCH_HZ = 260.0
"""Fundamental frequency of its voice: about the mean of mothers who speak to infants (Fernald et al. 1989, J Child Lang
16: 477; from memory)."""
LEVEL_DB = 60.0  # Sound pressure level of its voice at 1 m: that of conversation (from memory).
HAPPY, NEUTRAL = "happy", "neutral"
LOOKING_RAD, LOOKED_AWAY_RAD = math.radians(15), math.radians(20)
"""Angle between gaze and face up to which an infant looks at the face, and beyond which it looks elsewhere; an
assumption."""
SPOKEN_DB = 40.0
"""Sound pressure level at 1 m from which on the infant's voice is answered, a quiet voice; an assumption."""
LOOK_S = 0.2  # Shortest duration of a look; an assumption.
REMEMBERED = (
    "next",
    "acts",
    "said",
    "due",
    "answered",
    "noticed",
    "pauses_until",
    "is_answering",
    "shown",
    "smiles_until",
    "yoked_next",
    "attended",
)
"""What a caregiver remembers besides what its body and hands do, by the names of its attributes."""
Noted = tuple[int, str]  # A physics step, and the name of the infant that it is about.


class Onsets:
    """Tells when the infant begins to do something that can be answered: kick, look, speak or touch.

    A leg kicks when it has got longer by *kick_m* since it was shortest, and can kick again once it has got shorter by
    as much. A look begins when gaze has been at the face for a while; the voice with a sound of it; touch with a
    contact.
    """

    def __init__(self, to: str, infant: Infant, kick_m: float, timestep_s: float):
        self._begins: Callable[[mujoco.MjData, FloatArray, bool], bool] = {
            "kick": self._kicks,
            "gaze": self._looks,
            "vocalisation": self._speaks,
            "touch": self._touches,
        }[to]
        self._infant = infant
        self._kick_m = kick_m
        self._timestep_s = timestep_s
        self._sources: SoundSources | None = None
        self._voice: Voice | None = None
        self.reset()

    def reset(self) -> None:
        """Begin an episode."""
        self.state: dict[str, Any] = {"legs": [[False, None] for _ in self._infant.legs], "since": 0, "heard": -1}
        """State within an episode.

        `legs`: of each leg, whether it extends, and its greatest length since that began; or, if it bends, its least.
        `since`: physics steps of the present look or touch; for the voice, 1 while it is loud, else 0. `heard`: physics
        step in which the latest sound of the voice began, -1 for none.
        """

    def listen_to(self, sources: SoundSources, voice: Voice | None) -> None:
        """Hear these sources and the infant's own voice."""
        self._sources, self._voice = sources, voice

    def __call__(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        """Return whether it begins in the last physics step; *is_touched* says whether infant and caregiver touch."""
        return self._begins(data, face_m, is_touched)

    def _kicks(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        begins = False
        for leg, length_m in zip(self.state["legs"], self._infant.leg_lengths_m(data), strict=True):
            extends, extreme_m = leg
            extreme_m = length_m if extreme_m is None else (max if extends else min)(extreme_m, length_m)
            if abs(length_m - extreme_m) >= self._kick_m:
                begins |= not extends
                extends, extreme_m = not extends, length_m
            leg[:] = extends, extreme_m
        return begins

    def _looks(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        place_m, way = self._infant.gaze(data)
        to_face = (face_m - place_m) / np.linalg.norm(face_m - place_m)
        angle_rad = math.acos(min(max(float(way @ to_face), -1.0), 1.0))
        least_steps = round(LOOK_S / self._timestep_s)
        is_looking = self.state["since"] >= least_steps
        if angle_rad <= LOOKING_RAD or (is_looking and angle_rad <= LOOKED_AWAY_RAD):
            self.state["since"] += 1
        else:
            self.state["since"] = 0
        return self.state["since"] == least_steps

    def _touches(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        self.state["since"] = self.state["since"] + 1 if is_touched else 0
        return self.state["since"] == 1

    def _speaks(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        sounds = self._sources.sounds(data) if self._sources else ()
        starts = [sound.start_step for sound in sounds if sound.kind == "voice" and sound.source != NAME]
        latest = max(starts, default=-1)
        is_loud = self._voice is not None and self._voice.level_db > SPOKEN_DB
        begins = latest > self.state["heard"] or (is_loud and not self.state["since"])
        self.state |= {"heard": max(latest, self.state["heard"]), "since": int(is_loud)}
        return begins


class Caregiver(Companion):
    """An adult by the infant: `env.unwrapped.caregiver`.

    It acts by the script of the spec, answers what the infant does, and does what it is asked to, from the next physics
    step on. A class of a script's own that moves it overrides `decide`, which is called before each physics step:
    `mimoc.make(spec, companions={"caregiver": Nanny()})`.

    Example:
        >>> import mimoc
        >>> spec = mimoc.InfantSpec(mimoc=1, name="kim", age_months=4, scene={"caregiver": {}})
        >>> env = mimoc.make(spec)
        >>> _ = env.reset(seed=0)
        >>> env.unwrapped.caregiver.do("show_face", "happy")
        >>> env.unwrapped.caregiver.do("speak", pitch_hz=300)
        >>> _ = env.step(0 * env.action_space.sample())
        >>> env.unwrapped.caregiver.acts
        [(0, 'show_face', 'happy'), (0, 'speak', None)]
    """

    attends_to_all = True

    def bind(self, model: mujoco.MjModel, bundle: Any, generator: np.random.Generator) -> None:
        """Look up its bodies; see `Companion.bind`.

        Raises:
            MimocError: If there is no caregiver in the bundle.
        """
        manifest: Manifest | WorldManifest = bundle.manifest
        if manifest.caregiver is None:
            raise MimocError("this infant has no caregiver; add 'caregiver: {}' to the scene of its spec")
        self.entry: CaregiverEntry = manifest.caregiver
        self._generator = generator
        self._timestep_ms = manifest.timestep_ms
        manifests = manifests_of(bundle)
        self._first = self.entry.infant or next(iter(manifests))
        self.infants: Mapping[str, Infant] = {name: Infant(of_infant, model) for name, of_infant in manifests.items()}
        self.body = CaregiverBody(self.entry, model, self.infants.values())
        self.model_fields = self.body.model_fields
        self._objects = offered_objects(manifest, model)
        self._parts = {name: _parts(manifests[name], infant, model) for name, infant in self.infants.items()}
        self.hands = Hands(self.body, self.infants, self._objects)
        self._script = [(self._steps(act.at_ms), act) for act in self.entry.script]
        for _, act in self._script:
            self._check(act.do, act.what, act.infant, act.details)
        answers = self.entry.answers
        self._onsets: dict[str, Onsets] = {}  # By the names of the infants that are answered.
        for name, of_infant in manifests.items():
            is_answered = self.entry.answers_all or name == self._first
            if answers and is_answered and of_infant.caregiver and of_infant.caregiver.answers:
                kick_m = of_infant.caregiver.answers.kick_m
                self._onsets[name] = Onsets(answers.to, self.infants[name], kick_m, model.opt.timestep)
        self._yoked = [self._steps(at_ms) for at_ms in answers.yoked_ms] if answers else []
        self._forget()

    def decide(self, data: mujoco.MjData) -> None:
        """Decide what to do before each physics step; this does nothing, a class of a script's own calls `do`."""

    @property
    def infant(self) -> Infant:
        """The infant that it attends to."""
        return self.infants[self._attended]

    @property
    def attends_to(self) -> str:
        """The name of the infant that it attends to; an infant that is alone has the name ""."""
        return self._attended

    def do(self, act: str, what: str | None = None, infant: str | None = None, **details: float) -> None:
        """Do something from the next physics step on; see `caregiver.script` in the spec language.

        Args:
            act: What to do, such as `offer` or `look_away`.
            what: The face, the object or the part of the infant that it is about.
            infant: In a world with several infants, the one that it attends to from then on.
            details: Its numbers, by the keys of the spec, such as `weight_share`.

        Raises:
            UnknownNameError: If there is no such act, face, object, part, infant or number.
            MimocError: If the act is about something, and that is missing.
        """
        self._check(act, what, infant, details)
        self.orders = [*self.orders, {"act": act, "what": what, **({"infant": infant} if infant else {}), **details}]

    def obey(self, order: Mapping[str, Any]) -> None:
        """Do what was recorded; see `do`."""
        self.do(**order)

    @property
    def expression(self) -> str:
        """The facial expression that it shows now."""
        return self._shown if self._smiles_until is None else HAPPY

    @property
    def acts(self) -> list[tuple[int, str, str | None]]:
        """What it has done in this episode: the physics step, the act, and what this was about."""
        return list(self._acts)

    @property
    def answered(self) -> list[int]:
        """The physics steps of this episode in which answers began."""
        return [step for step, _ in self._answered]

    @property
    def answered_to(self) -> list[str]:
        """The names of the infants whom these answers were to."""
        return [name for _, name in self._answered]

    @property
    def noticed(self) -> list[int]:
        """The physics steps after which an infant had just done what can be answered, answered or not."""
        return [step for step, _ in self._noticed]

    @property
    def noticed_of(self) -> list[str]:
        """The names of the infants who had done it."""
        return [name for _, name in self._noticed]

    def listen_to(self, sources: SoundSources, voice: Voice | None = None, others: Sequence[Voice] = ()) -> None:
        """Hear the voice of an infant that is alone."""
        self.listen_to_infants({self._first: (sources, voice)})

    def listen_to_infants(self, voices: Mapping[str, tuple[SoundSources, Voice | None]]) -> None:
        """Hear what sounds about each infant, and its voice, by its name."""
        for name, (sources, voice) in voices.items():
            if name in self._onsets:
                self._onsets[name].listen_to(sources, voice)

    def reset(self, data: mujoco.MjData) -> None:
        """Start an episode."""
        self._forget()
        self.body.start(data, self.infant)
        self.hands.reset()
        for onsets in self._onsets.values():
            onsets.reset()
        self._show(self.entry.expression)

    def before_step(self, data: mujoco.MjData) -> None:
        """Begin what is due, and go on with what has begun."""
        step = step_of(data.time, self.body.timestep_s)
        while self._next < len(self._script) and self._script[self._next][0] <= step:
            act = self._script[self._next][1]
            self._next += 1
            self._begin(step, act.do, act.what, act.infant, act.details, data)
        self._answer(step, data)
        self.decide(data)
        for order in self.orders:
            details = {key: value for key, value in order.items() if key not in ("act", "what", "infant")}
            self._begin(step, order["act"], order["what"], order.get("infant"), details, data)
        self.orders = []
        if self._smiles_until is not None and step >= self._smiles_until:
            self._smiles_until = None
            self.body.show(self._shown)
        self.hands.advance(data)
        self.body.advance(data, self.infant, self.hands.carried)

    def after_step(self, data: mujoco.MjData) -> None:
        """Notice what infants have done."""
        answers = self.entry.answers
        step = step_of(data.time, self.body.timestep_s)
        if answers is None:
            return
        for name, onsets in self._onsets.items():
            is_touched = answers.to == "touch" and self.body.touches(data, self.infants[name])
            if not onsets(data, self.body.face_m(data), is_touched):
                continue
            self._noticed.append((step, name))
            if self._yoked or not self._is_answering or step < self._pauses_until:
                continue
            if self._generator.random() < answers.probability:
                due_step = step + self._steps(answers.delay_ms)
                self._due.append((due_step, name))
                self._pauses_until = due_step + self._steps(answers.pause_ms)

    def sounds(self, data: mujoco.MjData) -> Sequence[Sound]:
        """Return what it has said and can still be heard."""
        now_ms = 1000 * data.time
        self._said = [said for said in self._said if (said[0] * self._timestep_ms + said[1]) + SILENT_AFTER_MS > now_ms]
        return [self._sound(*said) for said in self._said]

    @property
    def state(self) -> dict[str, Any]:
        """All that it remembers within an episode."""
        kept = {name: getattr(self, f"_{name}") for name in REMEMBERED}
        of_infants = {"onsets": {name: onsets.state for name, onsets in self._onsets.items()}} if self._onsets else {}
        return {**kept, **of_infants, "orders": self.orders, "body": self.body.state, "hands": self.hands.state}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        for name in REMEMBERED:
            setattr(self, f"_{name}", state[name])
        for name, onsets in self._onsets.items():
            onsets.state = state["onsets"][name]
        self.orders = state["orders"]
        self.body.state = state["body"]
        self.hands.state = state["hands"]

    def _forget(self) -> None:
        self._next = 0  # Index of the next act of the script.
        self._yoked_next = 0  # Index of the next yoked answer.
        self._acts = list[tuple[int, str, str | None]]()
        self._said = list[tuple[Any, ...]]()
        self._due, self._answered, self._noticed = list[Noted](), list[Noted](), list[Noted]()
        self._attended = self._first
        self._is_answering = True
        self._pauses_until = 0
        self._shown = self.entry.expression
        self._smiles_until: int | None = None
        self.orders = []

    def _answer(self, step: int, data: mujoco.MjData) -> None:
        answers = self.entry.answers
        while self._yoked_next < len(self._yoked) and self._yoked[self._yoked_next] <= step:
            self._yoked_next += 1
            self._due.append((step, self._attended))
        for due_step, name in [noted for noted in self._due if noted[0] <= step]:
            self._due.remove((due_step, name))
            if answers and self._is_answering:
                self._answered.append((step, name))
                self._attend(name, data)
                for act in answers.by:
                    self._begin(step, act, None, None, {}, data)

    def _attend(self, infant: str, data: mujoco.MjData) -> None:
        """Attend to an infant from now on; if it is another one, turn to it."""
        if infant != self._attended:
            self._attended = infant
            self.body.look(True, data, self.infant)

    def _begin(
        self,
        step: int,
        act: str,
        what: str | None,
        infant: str | None,
        details: Mapping[str, float],
        data: mujoco.MjData,
    ) -> None:
        self._acts.append((step, act, what))
        if infant is not None:
            self._attend(infant, data)
        match act, what:
            case "show_face", str():
                self._show(what)
            case "smile", _:
                self.body.show(HAPPY)
                self._smiles_until = step + round(details.get("duration_ms", SMILE_MS) / self._timestep_ms)
            case "look_at" | "look_away", _:
                self.body.look(act == "look_at", data, self.infant)
            case "speak", _:
                numbers = (("duration_ms", VOICE_MS), ("pitch_hz", PITCH_HZ), ("level_db", LEVEL_DB))
                self._said.append((step, *(float(details.get(key, usual)) for key, usual in numbers)))
            case "offer", str():
                self.hands.offer(what, self._attended, data)
            case "hold", str():
                self.hands.hold(self._parts[self._attended][what], self._attended, details.get("weight_share"), data)
            case "release", _:
                self.hands.release(data)
            case _:  # Acts still_face and interact.
                self._show(self.entry.expression if act == "interact" else NEUTRAL)
                self._is_answering = act == "interact"
                self.body.look(True, data, self.infant)

    def _show(self, expression: str) -> None:
        """Show a facial expression until another one, smiles apart."""
        self._shown = expression
        self._smiles_until = None
        self.body.show(expression)

    def _check(self, act: str, what: str | None, infant: str | None, details: Mapping[str, float]) -> None:
        check_name("act of a caregiver", act, ACTS)
        about, numbers = ACTS[act]
        for key in details:
            if key not in numbers:
                raise UnknownNameError(f"number of '{act}'", key, numbers)
        if about and what is None:
            raise MimocError(f"'{act}' needs the name of the {about}: do('{act}', ...)")
        if infant is not None:
            check_name("name of an infant of this world", infant, self.infants)
        whose = [infant] if infant is not None else [*self.infants]
        parts = set.intersection(*(set(self._parts[name]) for name in whose))
        known = {"face": self.entry.materials, "object": self._objects, "part": parts}
        if about:
            check_name(f"{about} for '{act}'", str(what), known[about])

    def _steps(self, time_ms: float) -> int:
        return to_steps(time_ms, self._timestep_ms)

    def _sound(self, step: int, duration_ms: float, pitch_hz: float, level_db: float) -> Sound:
        return Sound(step, duration_ms, pitch_hz, level_db, "voice", NAME, self.body.head, self.entry.mouth_m)


def _parts(manifest: Manifest, infant: Infant, model: mujoco.MjModel) -> dict[str, int]:
    bodies = np.flatnonzero(model.body_rootid == infant.root).tolist()
    return {manifest.of_infant(model.body(body).name): body for body in bodies}


def offered_objects(manifest: Manifest | WorldManifest, model: mujoco.MjModel) -> dict[str, Offered]:
    """Return what a caregiver can offer, by name: objects of the spec that move freely, and toys.

    A toy has the name of its body, and, the first of them, that of its object and that of its category.
    """
    toys = [(toy.body, (toy.body, toy.object, toy.category)) for toy in manifest.toys]
    named = [(item.body, (item.name,)) for item in manifest.objects if item.motion == "free"]
    offered = dict[str, Offered]()
    for body, names in (*named, *toys):
        index = model.body(body).id
        geoms = range(model.body_geomadr[index], model.body_geomadr[index] + model.body_geomnum[index])
        reaches_m = [float(np.linalg.norm(model.geom_pos[geom]) + model.geom_rbound[geom]) for geom in geoms]
        for name in names:
            offered.setdefault(name, Offered(index, max(reaches_m)))
    return offered


bind = Caregiver
