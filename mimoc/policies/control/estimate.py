"""The state of the body as an infant takes it to be, from its own senses and the commands that it has sent.

A forward model, a copy of the infant and its world, is driven by efference copies: the commands that the infant sends.
It lives where commands that are sent now act everywhere, after the longest delay of commands. What the senses tell is
older than that by this delay and their own. It is compared with what the forward model was at that time, and the
difference corrects the present:

    senses          commands sent now act
      |<-- sensory delay -->|<-- motor delay -->|
    compared               now             the estimate                         time ->

The gains are those of a steady Kalman filter (`body_filter`): how errors of angles and speeds grow is found by
linearising the forward model where an episode begins, how fast by the noise of commands, and how much a reading is
worth by the noise of its sense. The errors of proprioception are slow, and estimated with the rest.
"""

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from scipy.linalg import block_diag

from mimoc.base.errors import ControlError
from mimoc.base.units import GRAVITY_M_S2, ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.policies.control.forward_model import copy_state, late_groups
from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.delays import Timing, within
from mimoc.runtime.infant import Infant
from mimoc.runtime.noise import bind_noise, smooth_step
from mimoc.runtime.sense import FloatArray, IntArray, Observation

JOINTS, BALANCE, SKIN = "proprioception", "vestibular", "touch"
NEEDED = {JOINTS: "the angles of joints", BALANCE: "the tilt of the trunk"}
"""The senses that an estimate needs, and what each tells."""
ANGLE_END, SPEED_END = " angle [rad]", " velocity [rad/s]"  # How names of angles and speeds end in the layout.
FORCE, ROTATION = "m/s²", "rad/s"  # Units of what the vestibular sense tells.

TYPICAL_DRIVE = 0.1
"""Drive of an actuator whose noise counts at least, as a share of its strength: muscles at rest are not still (a
choice)."""
MODEL_ERROR = 0.02  # Share of an actuator's strength by which the forward model errs without noise (a choice).
DRIVE_ERROR_S = 0.06  # Time constant of errors of the drive: that of noise of commands.
JOLT_RAD_S = 0.05
"""What else changes a speed in a control step, standard deviation, [rad/s] or [m/s]: contacts that the linear model
does not foresee. At 0.01, errors of 5 to 15 degrees stayed for seconds."""
LEAST_RAD, LEAST_RAD_S = 0.01, 0.1
"""Standard deviations of the most exact angles and speeds: no sense is exact, and filters are sound (a choice)."""
LEAST_SPIN_RAD_S = 0.02  # Standard deviation of the most exact sense of rotation (a choice).
SHAKEN_M_S2 = 0.3
"""Standard deviation of the specific force that comes of what a linear forward model does not foresee (a choice)."""
PLACE_M, HEADING_RAD = 1e-3, 1e-3  # Standard deviations of where the infant is on the floor, which sight tells.
MIN_SHARE_OF_G, MAX_SHARE_OF_G = 0.5, 1.5  # Specific force beyond these tells of knocks, not of tilt (a choice).
MOST_SURPRISED = 5.0  # Standard deviations beyond which a surprise counts no more (a choice).
MAX_DOUBLINGS, CONVERGED = 40, 1e-9
FD_STEP = 1e-6  # Step of the finite differences that linearise the forward model.
SAME_COMMAND = 1e-6  # Difference of commands that is one of rounding.
MAX_RAD_S = 60.0
"""Speed from which on a forward model foresees no motion of an infant and begins again in the true state, [rad/s] or
[m/s]: several times the fastest of kicks and falls (a choice)."""
TOUCHED_N = 0.02  # Force from which on the skin reports a contact (a choice).
SUPPORT_GAIN = 0.2  # Share of a gap below a part that feels the floor that is closed in a control step (a choice).


def steady_gain(
    transition: FloatArray, sensed: FloatArray, process: FloatArray, noise: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the gain of a steady Kalman filter, shape (n, m), and the standard deviations of its surprises, (m,).

    With the state x' = A x + w and the reading z = C x + v, where w has the covariance Q and v has R, P solves
    P = A P Aᵀ + Q - A P Cᵀ (C P Cᵀ + R)⁻¹ C P Aᵀ, and the gain is P Cᵀ (C P Cᵀ + R)⁻¹ (Kalman 1960). P is found by
    doubling the steps that the filter has been running for (Anderson 1978), which is ten times as fast as by
    eigenvalues.

    Args:
        transition: A, shape (n, n).
        sensed: C, shape (m, n).
        process: Q, shape (n, n).
        noise: The diagonal of R, shape (m,).

    Raises:
        ControlError: If there is no steady filter, as something that grows is not sensed.
    """
    steps, informed = transition.T, sensed.T @ (sensed / noise[:, None])
    spread = process
    for _ in range(MAX_DOUBLINGS):
        mixed = np.eye(len(spread)) + informed @ spread
        both = np.linalg.solve(mixed, np.concatenate([steps, informed @ steps.T], axis=1))
        size = len(spread)
        with np.errstate(over="ignore", invalid="ignore"):
            added = steps.T @ spread @ both[:, :size]
            informed = informed + steps @ both[:, size:]
            steps = steps @ both[:, :size]
            spread = spread + added
            spread = (spread + spread.T) / 2
        if not (np.isfinite(spread).all() and np.isfinite(steps).all() and np.isfinite(informed).all()):
            break
        if np.abs(added).max() <= CONVERGED * np.abs(spread).max():
            surprise = sensed @ spread @ sensed.T + np.diag(noise)
            gain = np.asarray(np.linalg.solve(surprise, sensed @ spread).T, np.float64)
            return gain, np.sqrt(np.diag(surprise))
    raise ControlError("no steady filter tells the state of this body from its senses")


@dataclass(frozen=True)
class SenseNoise:
    """How far senses and commands err, as an infant knows from having lived with them."""

    angle_rad: float = 0.0  # Standard deviation of sensed angles.
    angle_s: float = 0.5  # Time constant of their errors.
    force_m_s2: float = 0.0  # Standard deviation of one reading of specific force, if they were independent.
    rotation_rad_s: float = 0.0  # The same of angular velocity.
    commands: float = 0.0  # Standard deviation of what actuators are driven by, as a share of commands.

    @classmethod
    def of(cls, infant: Infant) -> "SenseNoise":
        """Return the noise of an infant that has all senses of `NEEDED`."""
        entry = infant.manifest.noise
        of_joints: Any = bind_noise(JOINTS, infant.senses[JOINTS], entry)
        of_balance: Any = bind_noise(BALANCE, infant.senses[BALANCE], entry)
        kept = math.exp(-ms_to_s(infant.manifest.step_ms) / of_balance.low_pass.time_constant_s)
        as_white = math.sqrt((1 + kept) / (1 - kept))  # Readings whose errors correlate tell less.
        largest = dict(zip(_units(infant), of_balance.deviation.tolist(), strict=True))
        return cls(
            angle_rad=float(of_joints.deviation_rad[0]),
            angle_s=of_joints.low_pass.time_constant_s,
            force_m_s2=as_white * largest.get(FORCE, 0.0),
            rotation_rad_s=as_white * largest.get(ROTATION, 0.0),
            commands=float(np.mean(entry.of_commands)) if entry.of_commands else entry.motor,
        )


def _units(infant: Infant) -> list[str]:
    return [name.rsplit("[", 1)[1].rstrip("]") for name in infant.senses[BALANCE].layout]


@dataclass(frozen=True)
class Organs:
    """Where the senses are that an estimate reads, and after how many physics steps each tells."""

    hinges: IntArray  # Indices of the s sensed hinges in the model, shape (s,).
    hinge_steps: IntArray  # Delay of each, shape (s,).
    head: int  # Body of the vestibular organ, whose frame its sensors have.
    step_s: float  # Duration of a control step.
    force: int | None  # Where specific force begins in `sensordata`; None if it is not sensed.
    rotation: int | None  # Where angular velocity begins in it; None if it is not sensed.
    balance_steps: int  # Delay of the vestibular sense.
    noise: SenseNoise
    senses_speed: bool = True  # Whether speeds of joints are sensed.

    @property
    def delay_steps(self) -> IntArray:
        """Physics steps after which each number of a reading is told, shape (m,); see `BodyFilter`."""
        balance = np.full(3, self.balance_steps)
        parts = [
            self.hinge_steps,
            *([self.hinge_steps] if self.senses_speed else []),
            *([balance] if self.force is not None else []),
            *([balance] if self.rotation is not None else []),
            np.zeros(3, np.intp),
        ]
        return np.concatenate(parts).astype(np.intp)

    @classmethod
    def of(cls, model: mujoco.MjModel, manifest: Manifest, timing: Timing, noise: SenseNoise) -> "Organs":
        """Return the organs of an infant that has all senses of `NEEDED`."""
        joints: Any = getattr(manifest.senses, JOINTS)
        balance: Any = getattr(manifest.senses, BALANCE)
        hinges = np.array([model.joint(name).id for name in joints.joints], np.intp)
        bodies = model.jnt_bodyid[hinges].astype(np.intp)
        sensors = [model.sensor(name) for name in (balance.accelerometer, balance.gyro) if name]
        return cls(
            hinges=hinges,
            hinge_steps=timing.delay_steps(JOINTS, within(model, bodies), len(hinges)),
            head=int(model.site_bodyid[int(sensors[0].objid[0])]),
            step_s=ms_to_s(timing.step_ms),
            force=_sensor_start(model, balance.accelerometer),
            rotation=_sensor_start(model, balance.gyro),
            balance_steps=int(timing.delay_steps(BALANCE, None, 1)[0]),
            noise=noise,
            senses_speed="velocity" in joints.include,
        )


def _sensor_start(model: mujoco.MjModel, name: str | None) -> int | None:
    return int(model.sensor(name).adr[0]) if name else None


def lacking(manifest: Manifest) -> tuple[str, ...]:
    """Return which senses an infant lacks for an estimate of its body."""
    return tuple(name for name in NEEDED if getattr(manifest.senses, name, None) is None)


def told_of(manifest: Manifest, reads_truth: bool, times_lost: int = 0) -> tuple[str, ...]:
    """Return in sentences what an infant knows of its body that its senses do not tell.

    *times_lost* is how often its estimate was lost; see `Estimate`.
    """
    if reads_truth:
        return ("it reads the true state of its body, as asked",)
    if missing := lacking(manifest):
        what = " and ".join(NEEDED[name] for name in missing)
        senses = " and ".join(f"'{name}'" for name in missing)
        return (f"it reads the true state of its body, as no sense tells {what}; add {senses} to the senses",)
    notes = list[str]()
    if getattr(manifest.senses, SKIN, None) is None:
        notes.append("without 'touch', what carries the body is foreseen and not felt")
    if times_lost:
        how_often = "once" if times_lost == 1 else f"{times_lost} times"
        notes.append(f"its estimate of its body was lost {how_often}, and began again in the true state")
    return tuple(notes)


@dataclass(frozen=True)
class Reading:
    """What senses told in one control step, of the times that lie their delays before it."""

    angles_rad: FloatArray  # Of the s sensed hinges, shape (s,).
    speeds_rad_s: FloatArray | None  # Their speeds, shape (s,), if they are sensed.
    force_m_s2: FloatArray | None  # Specific force in the frame of the head's sensor, shape (3,).
    rotation_rad_s: FloatArray | None  # Angular velocity in this frame, shape (3,).
    touched: frozenset[int] | None = None  # Bodies whose skin is touched; None without a sense of touch.


class Reader:
    """Reads what an estimate needs from the observations of an infant."""

    def __init__(self, infant: Infant):
        names = infant.senses[JOINTS].layout
        self._angles = np.flatnonzero([name.endswith(ANGLE_END) for name in names])
        self._speeds = np.flatnonzero([name.endswith(SPEED_END) for name in names])
        units = _units(infant)
        self._force = np.flatnonzero([unit == FORCE for unit in units])
        self._rotation = np.flatnonzero([unit == ROTATION for unit in units])
        self._skin = infant.senses[SKIN].bodies if SKIN in infant.senses else None

    def __call__(self, observation: Observation) -> Reading:
        """Return the reading of an observation."""
        joints = observation[JOINTS].astype(np.float64)
        balance = observation[BALANCE].astype(np.float64)
        touched = None
        if self._skin is not None:
            touched = frozenset(self._skin[np.abs(observation[SKIN]) > TOUCHED_N].tolist())
        return Reading(
            angles_rad=joints[self._angles],
            speeds_rad_s=joints[self._speeds] if self._speeds.size else None,
            force_m_s2=balance[self._force] if self._force.size else None,
            rotation_rad_s=balance[self._rotation] if self._rotation.size else None,
            touched=touched,
        )


@dataclass(frozen=True)
class BodyFilter:
    """The gains of an estimate.

    The state has n angles and places of the infant, their n speeds, and the errors of s sensed angles with their rates;
    a reading has the s angles, the s speeds if they are sensed, what the vestibular sense tells, and the infant's place
    and heading on the floor.
    """

    gain: FloatArray  # Of the state at the time of each reading, shape (2 n + 2 s, m).
    step: FloatArray  # How errors of angles and speeds go on in a physics step, shape (2 n, 2 n).
    balance: FloatArray  # Tilt and angular velocity of the head, by angles and speeds, shape (6, 2 n).
    surprises: FloatArray  # Standard deviation of each number of a reading, as it is expected, shape (m,).


def body_filter(
    model: mujoco.MjModel, data: mujoco.MjData, organs: "Organs", dofs: IntArray, control_steps: int
) -> BodyFilter:
    """Return the steady Kalman filter of an infant in a posture.

    Args:
        model: The infant and its world.
        data: The posture, with the activations that keep it.
        organs: Its senses.
        dofs: The degrees of freedom of the infant, its root's first, shape (n,).
        control_steps: Physics steps in a control step.
    """
    nv, na, step_s = model.nv, model.na, model.opt.timestep
    size = 2 * nv + na
    transition, driven = np.zeros((size, size)), np.zeros((size, model.nu))
    sensors = np.zeros((model.nsensordata, size))
    mujoco.mjd_transitionFD(model, copy.copy(data), FD_STEP, False, transition, driven, sensors, None)
    own = np.concatenate([dofs, nv + dofs])
    in_step = transition[np.ix_(own, own)]
    by_drive = transition[own, 2 * nv :] if na else driven[own]
    drive = np.abs(data.act if na else data.ctrl)
    error = organs.noise.commands * np.maximum(drive, TYPICAL_DRIVE) + MODEL_ERROR
    kept = math.exp(-step_s / DRIVE_ERROR_S)
    disturbed = by_drive * error * math.sqrt((1 + kept) / (1 - kept))  # A step's worth of errors that last.
    body, process = np.eye(len(own)), np.zeros((len(own), len(own)))
    for _ in range(control_steps):
        process += body @ disturbed @ disturbed.T @ body.T
        body = in_step @ body
    process[len(dofs) :, len(dofs) :] += JOLT_RAD_S**2 * np.eye(len(dofs))
    errors, drift = _error_model(organs, control_steps * step_s)
    balance = np.zeros((6, len(own)))
    balance[:3] = _upright(model, data, organs.head)[:, own]
    if organs.rotation is not None:
        balance[3:] = sensors[organs.rotation : organs.rotation + 3, own]
    sensed, noise = _sensed(model, data, organs, dofs, balance)
    transition_of_all = np.asarray(block_diag(body, errors), np.float64)
    process_of_all = np.asarray(block_diag(process, drift), np.float64)
    gain, surprises = steady_gain(transition_of_all, sensed, process_of_all, noise)
    return BodyFilter(gain, in_step, balance, surprises)


def _upright(model: mujoco.MjModel, data: mujoco.MjData, head: int) -> FloatArray:
    """Return by how much angles and speeds tilt the head, in its own frame, shape (3, 2 nv)."""
    turning = np.zeros((3, model.nv))
    mujoco.mj_jacBody(model, data, None, turning, head)
    level = np.diag([1.0, 1.0, 0.0])
    return np.hstack([data.xmat[head].reshape(3, 3).T @ level @ turning, np.zeros((3, model.nv))])


def _error_model(organs: "Organs", step_s: float) -> tuple[FloatArray, FloatArray]:
    """Return how the errors of sensed angles and their rates go on, and the covariance of what is added to them."""
    value, rate, (first, mixed, second) = smooth_step(step_s / organs.noise.angle_s)
    added = np.array([[first, 0.0], [mixed, second]])
    each = np.eye(len(organs.hinges))
    goes_on = np.asarray(np.kron(np.array([value, rate]), each), np.float64)
    return goes_on, np.asarray(np.kron(added @ added.T, each), np.float64)


def _sensed(
    model: mujoco.MjModel, data: mujoco.MjData, organs: "Organs", dofs: IntArray, balance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what a reading is of the state, and the variances of its noise; for *balance* see `BodyFilter`."""
    noise, count, n = organs.noise, len(organs.hinges), len(dofs)
    hinges = np.searchsorted(dofs, model.jnt_dofadr[organs.hinges])
    each, none = np.eye(count), np.zeros((count, count))
    of_angles = np.zeros((count, 2 * n))
    of_angles[np.arange(count), hinges] = 1.0
    rows = [np.hstack([of_angles, noise.angle_rad * each, none])]
    variances = [np.full(count, LEAST_RAD**2)]
    if organs.senses_speed:
        rows.append(np.hstack([np.roll(of_angles, n, axis=1), none, noise.angle_rad / noise.angle_s * each]))
        variances.append(np.full(count, LEAST_RAD_S**2))
    rest = np.zeros((3, 2 * count))
    if organs.force is not None:
        kept = math.exp(-organs.step_s / DRIVE_ERROR_S)
        shaken_m_s2 = math.hypot(noise.force_m_s2, SHAKEN_M_S2 * math.sqrt((1 + kept) / (1 - kept)))
        rows.append(np.hstack([balance[:3], rest]))
        variances.append(np.full(3, (shaken_m_s2 / GRAVITY_M_S2) ** 2))
    if organs.rotation is not None:
        rows.append(np.hstack([balance[3:], rest]))
        variances.append(np.full(3, noise.rotation_rad_s**2 + LEAST_SPIN_RAD_S**2))
    place = np.zeros((3, 2 * n + 2 * count))
    place[0, 0] = place[1, 1] = 1.0
    place[2, 3:6] = data.xmat[model.dof_bodyid[dofs[0]]].reshape(3, 3)[2]
    rows.append(place)
    variances.append(np.array([PLACE_M**2, PLACE_M**2, HEADING_RAD**2]))
    return np.concatenate(rows), np.concatenate(variances)


@dataclass
class _Past:
    """What the forward model was after each of the last t physics steps, the latest last."""

    qpos: FloatArray  # Shape (t, nq).
    qvel: FloatArray  # Shape (t, nv).
    balance: FloatArray  # Specific force and angular velocity of the head, shape (t, 6).
    corrected: FloatArray  # By how much tilt and angular velocity of the head were corrected since, shape (t, 6).

    def append(self, qpos: FloatArray, qvel: FloatArray, balance: FloatArray) -> None:
        new = (qpos, qvel, balance, np.zeros(6))
        for rows, row in zip((self.qpos, self.qvel, self.balance, self.corrected), new, strict=True):
            rows[:-1] = rows[1:]
            rows[-1] = row

    def forget(self, steps: int) -> None:
        """Take back the latest steps."""
        for rows in (self.qpos, self.qvel, self.balance, self.corrected):
            rows[steps:] = rows[:-steps].copy()


@dataclass(frozen=True, slots=True)
class _Held:
    """Actuators whose commands are held back, so that they act together with those that take longest."""

    commands: IntArray  # Indices among all m commands.
    actuators: IntArray  # Indices in the model.
    held: int  # Control steps for which a command is held back.
    late: int  # Physics steps by which it then acts too late, as it is held back for whole control steps.


class Estimate:
    """The state of the body that an infant acts from, at the time at which the commands that it sends now act.

    Commands to nearer muscles are held back, so that all act at one time. The rest of the infant's world, and where on
    the floor it is, are as in the simulation now: no sense of the body tells them.
    """

    def __init__(
        self,
        infant: DrivenInfant,
        actuators: IntArray,
        timing: Timing,
        organs: Organs,
        believed: mujoco.MjModel | None = None,
        held: Sequence[int] = (),
    ):
        """Prepare the estimate of an infant whose actions command *actuators*, shape (m,), all those that it has.

        *believed* is the model of the infant's body as it takes it to be; None is the real one. *held* are degrees of
        freedom that something holds where they are, so that no sense corrects them.
        """
        self._infant, self._organs, self._actuators = infant, organs, actuators
        self._held_dofs = held
        self._model = model = _without_own_contacts(infant, infant.model if believed is None else believed)
        self.control_steps = timing.period
        """Physics steps in a control step."""
        self.data = mujoco.MjData(model)
        """The state, with all that `mj_step1` computes of it."""
        groups = late_groups(model, actuators, timing)
        self.delay_steps = np.zeros(len(actuators), np.intp)
        """Physics steps after which commands act, shape (m,)."""
        for group in groups:
            self.delay_steps[group.commands] = group.begin
        self.lead_steps = int(self.delay_steps.max(initial=0))
        """Physics steps from now to the time of the estimate."""
        self._groups = list[_Held]()
        for group in groups:
            back = -((group.begin - self.lead_steps) // self.control_steps)
            late = group.begin + back * self.control_steps - self.lead_steps
            self._groups.append(_Held(group.commands, group.actuators, back, late))
        longest = max((group.held for group in self._groups), default=0)
        self._planned = np.zeros((longest + 1, len(actuators)))  # The latest commands, the newest last.
        self._sent = np.zeros((2, len(actuators)))  # The commands of the last two control steps, as they were sent.
        self._said = np.zeros(len(actuators))  # Those that were given out last.
        self._before: tuple[FloatArray, ...] = ()  # The state before the last control step.
        delays = organs.delay_steps
        self._waits = (delays.max() - delays) // self.control_steps
        """Control steps for which each number of a reading waits for the slowest, so that all are of one time."""
        self._late = self.lead_steps + delays + self._waits * self.control_steps
        """Physics steps from the time of each number of a reading to that of the estimate."""
        self._told = np.zeros((int(self._waits.max()) + 1, len(delays)))  # The latest readings, the newest last.
        rows = int(self._late.max()) + 1 + self.control_steps
        self._past = _Past(
            np.zeros((rows, model.nq)), np.zeros((rows, model.nv)), np.zeros((rows, 6)), np.zeros((rows, 6))
        )
        self._errors = np.zeros((2, len(organs.hinges)))
        """Errors of sensed angles and their rates, in standard deviations, as estimated."""
        self._filter: BodyFilter | None = None
        self._settled: tuple[mujoco.MjData, BodyFilter] | None = None  # The last settled state, and its filter.
        self.times_lost = 0
        """How often it foresaw no motion of an infant, and began again in the true state."""
        self._find_places()

    def _find_places(self) -> None:
        model, hinges = self._model, self._organs.hinges
        self._angles = model.jnt_qposadr[hinges]
        self._speeds = model.jnt_dofadr[hinges]
        self._place = self._infant.place
        of_own = self._infant.is_own[model.jnt_bodyid]
        self._dofs = np.flatnonzero(self._infant.is_own[model.dof_bodyid]).astype(np.intp)
        at = np.searchsorted(self._dofs, np.asarray(self._held_dofs, np.intp))
        self._held = np.concatenate([at, len(self._dofs) + at])  # Their columns in changes of places and speeds.
        self._others_speeds = np.flatnonzero(~self._infant.is_own[model.dof_bodyid])
        places = np.diff([*model.jnt_qposadr.tolist(), model.nq])
        self._others_places = np.flatnonzero(~np.repeat(of_own, places))

    # What it is told.

    def begin(self, data: mujoco.MjData, commands: FloatArray, settled: mujoco.MjData | None = None) -> None:
        """Begin an episode in a state that is known, with commands, (m,), held since before it began.

        The filter is that of the state *settled*, in which the infant rests in its posture; None keeps the last one.
        """
        own = self.data
        copy_state(self._model, data, own)
        own.qfrc_applied[:] = 0.0
        own.xfrc_applied[:] = 0.0
        own.warning.number[:] = 0
        own.ctrl[self._actuators] = commands
        self._planned[:], self._sent[:], self._said = commands, commands, commands.copy()
        self._errors[:] = 0.0
        self._before = ()
        mujoco.mj_forward(self._model, own)
        balance = self._balance()
        for _ in self._past.qpos:
            self._past.append(own.qpos, own.qvel, balance)
        self._told[:] = self._foreseen()
        if settled is not None:
            if self._settled is None or self._settled[0] is not settled:
                found = body_filter(self._model, settled, self._organs, self._dofs, self.control_steps)
                self._settled = settled, found
            self._use(self._settled[1])
        for _ in range(self.lead_steps):
            self._step()
        mujoco.mj_step1(self._model, own)

    def see(self, reading: Reading, data: mujoco.MjData, sent: FloatArray | None) -> None:
        """Correct the estimate by what the senses tell, before the next commands are chosen.

        Args:
            reading: What they tell.
            data: The simulation, for what is around the infant and where on the floor it is.
            sent: Commands that were in fact sent in the last control step, shape (m,), such as those that other
                policies have added to; those of a voice may stand behind them. None if they are those of this estimate.
        """
        sent = None if sent is None else sent[: len(self._said)]
        if self.data.warning.number.any() or np.abs(self.data.qvel[self._dofs]).max() > MAX_RAD_S:
            self.times_lost += 1
            self.begin(data, self._sent[-1].copy())
        if sent is not None and self._before and np.abs(sent - self._said).max(initial=0.0) > SAME_COMMAND:
            self._repeat(self._sent[-1] + sent - self._said)
        self._notice_others(data)
        self._correct(reading, data)
        self._feel_support(reading)
        mujoco.mj_step1(self._model, self.data)

    def advance(self, number: int, commands: FloatArray) -> None:
        """Let a physics step pass, number *number* of the control step for which commands, shape (m,), are sent now."""
        own = self.data
        if number == 0:
            self._before = own.qpos.copy(), own.qvel.copy(), own.act.copy(), own.ctrl.copy()
        else:
            mujoco.mj_step1(self._model, own)
        self._apply(number, commands, self._sent[-1])
        mujoco.mj_step2(self._model, own)
        self._past.append(own.qpos, own.qvel, self._balance())

    def send(self, commands: FloatArray) -> FloatArray:
        """Take the commands, shape (m,), of the control step that has passed; return those to be sent now."""
        for rows in (self._planned, self._sent):
            rows[:-1] = rows[1:]
            rows[-1] = commands
        said = commands.copy()
        for group in self._groups:
            said[group.commands] = self._planned[-1 - group.held, group.commands]
        self._said = said
        return said

    def become(self, former: "Estimate", data: mujoco.MjData, settled: mujoco.MjData) -> None:
        """Go on from the estimate of the same infant at another age, with its errors, in its new state.

        For *settled* see `begin`.
        """
        self.times_lost = former.times_lost
        same = former._sent.shape == self._sent.shape and former._past.qpos.shape[1:] == self._past.qpos.shape[1:]
        self.begin(data, former._sent[-1].copy() if same else data.ctrl[self._actuators], settled)
        if same and former._error:
            self._shift(np.tile(np.concatenate(former._error), (len(self._past.qpos), 1)))
            self._errors[:] = former._errors
            mujoco.mj_step1(self._model, self.data)

    _error: tuple[FloatArray, FloatArray] | None = None  # The last errors of places and speeds, for `become` alone.

    # How it is corrected.

    def _apply(self, number: int, commands: FloatArray, earlier: FloatArray) -> None:
        for group in self._groups:
            arriving = commands if number >= group.late else earlier
            self.data.ctrl[group.actuators] = arriving[group.commands]

    def _step(self) -> None:
        mujoco.mj_step(self._model, self.data)
        self._past.append(self.data.qpos, self.data.qvel, self._balance())

    def _repeat(self, commands: FloatArray) -> None:
        """Simulate the last control step again, with other commands."""
        own = self.data
        own.qpos[:], own.qvel[:], own.act[:], own.ctrl[:] = self._before
        self._past.forget(self.control_steps)
        self._sent[-1] = commands
        for number in range(self.control_steps):
            self._apply(number, commands, self._sent[-2])
            self._step()

    def _notice_others(self, data: mujoco.MjData) -> None:
        """Take over what is not the infant's own: other bodies, and what holds it."""
        own = self.data
        own.qpos[self._others_places] = data.qpos[self._others_places]
        own.qvel[self._others_speeds] = data.qvel[self._others_speeds]
        own.mocap_pos[:], own.mocap_quat[:] = data.mocap_pos, data.mocap_quat
        own.eq_active[:] = data.eq_active

    def _correct(self, reading: Reading, data: mujoco.MjData) -> None:
        assert self._filter is not None
        noise, past, count = self._organs.noise, self._past, len(self._dofs)
        value, rate, _ = smooth_step(self._organs.step_s / noise.angle_s)
        self._errors = np.array([value, rate]) @ self._errors
        numbers = self._numbers(reading, data)
        if not self._before:
            self._begin_told(numbers)
        self._told[:-1] = self._told[1:]
        self._told[-1] = numbers
        told = self._told[-1 - self._waits, np.arange(len(self._waits))]
        most = MOST_SURPRISED * self._filter.surprises
        surprise = np.clip(self._surprise(told), -most, most)
        self._errors += (self._filter.gain[2 * count :] @ surprise).reshape(2, -1)
        self._shift((self._by_row @ surprise).reshape(len(past.qpos), 2 * count))
        now = -1 - self.lead_steps
        error, faster = np.zeros(self._model.nv), past.qvel[now] - data.qvel
        mujoco.mj_differentiatePos(self._model, error, 1.0, data.qpos, past.qpos[now])
        self._error = error[self._dofs], faster[self._dofs]

    def _begin_told(self, numbers: FloatArray) -> None:
        """Take what the senses tell first, shape (m,), for what they have told of the posture of the beginning."""
        noise, count = self._organs.noise, len(self._angles)
        self._told[:] = numbers
        if noise.angle_rad:
            of_angles, of_speeds = (self._surprise(numbers)[start : start + count] for start in (0, count))
            self._errors[0] = of_angles / noise.angle_rad
            if self._organs.senses_speed:
                self._errors[1] = of_speeds * noise.angle_s / noise.angle_rad

    def _numbers(self, reading: Reading, data: mujoco.MjData) -> FloatArray:
        """Return what the senses told now as one array, shape (m,); see `BodyFilter`."""
        parts = (reading.angles_rad, reading.speeds_rad_s, reading.force_m_s2, reading.rotation_rad_s)
        told = [part for part in parts if part is not None]
        place = data.qpos[self._place]
        return np.concatenate([*told, place[:2], [_heading_rad(place[3:])]])

    def _foreseen(self) -> FloatArray:
        """Return the reading of the present state, shape (m,), as it is when an episode begins."""
        own, organs, balance = self.data, self._organs, self._balance()
        reading = Reading(
            angles_rad=own.qpos[self._angles],
            speeds_rad_s=own.qvel[self._speeds] if organs.senses_speed else None,
            force_m_s2=None if organs.force is None else balance[:3],
            rotation_rad_s=None if organs.rotation is None else balance[3:],
        )
        return self._numbers(reading, own)

    def _surprise(self, told: FloatArray) -> FloatArray:
        """Return by how much what was told, shape (m,), differs from what was foreseen of its time, shape (m,)."""
        past, organs, rows = self._past, self._organs, -1 - self._late
        count = len(self._angles)
        scale = organs.noise.angle_rad
        surprise = told.copy()
        surprise[:count] -= past.qpos[rows[:count], self._angles] + scale * self._errors[0]
        done = count
        if organs.senses_speed:
            error_rad_s = scale / organs.noise.angle_s * self._errors[1]
            surprise[done : done + count] -= past.qvel[rows[:count], self._speeds] + error_rad_s
            done += count
        balance, corrected = past.balance[rows[done]], past.corrected[rows[done]]
        if organs.force is not None:
            surprise[done : done + 3] = _tilt(told[done : done + 3], balance[:3]) - corrected[:3]
            done += 3
        if organs.rotation is not None:
            surprise[done : done + 3] -= balance[3:] + corrected[3:]
            done += 3
        place = past.qpos[rows[done], self._place]
        surprise[done : done + 2] -= place[:2]
        turned_rad = told[done + 2] - _heading_rad(place[3:])
        surprise[done + 2] = (turned_rad + math.pi) % (2 * math.pi) - math.pi
        return surprise

    def _feel_support(self, reading: Reading) -> None:
        """Lower the body where a part feels a contact that the forward model has not, if nothing carries it there."""
        if not reading.touched:
            return
        own, model = self.data, self._model
        pairs = self._infant.is_own[model.geom_bodyid[own.contact.geom]].reshape(-1, 2)
        if (pairs.sum(axis=1) == 1).any():
            return
        lowest_m = min(self._infant.lowest_m(own, self._infant.part(body)) for body in reading.touched)
        if lowest_m > 0.0:
            changes = np.zeros((len(self._past.qpos), 2 * len(self._dofs)))
            changes[:, 2] = -SUPPORT_GAIN * lowest_m
            self._shift(changes)

    def _shift(self, changes: FloatArray) -> None:
        """Change places and then speeds, shape (t, 2 n), of all that is remembered, and of the present as the last."""
        own, past, change, count = self.data, self._past, np.zeros(self._model.nv), len(self._dofs)
        if len(self._held):
            changes[:, self._held] = 0.0
        for row, change[self._dofs] in zip(past.qpos, changes[:, :count], strict=True):
            mujoco.mj_integratePos(self._model, row, change, 1.0)
        past.qvel[:, self._dofs] += changes[:, count:]
        if self._filter:
            past.corrected += changes @ self._filter.balance.T
        own.qpos[:], own.qvel[:] = past.qpos[-1], past.qvel[-1]

    def _use(self, of_body: BodyFilter) -> None:
        """Take a filter, and find by how much each reading corrects the forward model at each remembered time.

        A correction of the time of a reading goes on as errors do: by the linearised physics steps since then.
        """
        if of_body is self._filter:
            return
        self._filter = of_body
        rows, count = len(self._past.qpos), len(self._dofs)
        at = rows - 1 - self._late  # The row of each reading.
        gain = self._filter.gain[: 2 * count]
        by_row = np.zeros((rows, *gain.shape))
        going_on = np.zeros_like(gain)
        for row in range(rows):
            going_on = self._filter.step @ going_on
            going_on[:, at == row] = gain[:, at == row]
            by_row[row] = np.where(at >= row, gain, going_on)
        self._by_row = by_row.reshape(rows * 2 * count, -1)

    def _balance(self) -> FloatArray:
        sensed = self.data.sensordata
        felt = np.zeros(6)
        for place, start in ((0, self._organs.force), (3, self._organs.rotation)):
            if start is not None:
                felt[place : place + 3] = sensed[start : start + 3]
        return felt

    # Its state.

    @property
    def _physics(self) -> tuple[FloatArray, ...]:
        """All that decides how it goes on, with the forces of contacts, which the controller reads."""
        own = self.data
        return own.qpos, own.qvel, own.act, own.ctrl, own.qacc_warmstart, own.qfrc_constraint

    @property
    def state(self) -> dict[str, Any]:
        """All that it remembers."""
        own = self.data
        return {
            "physics": [array.copy() for array in self._physics],
            "others": [own.mocap_pos.copy(), own.mocap_quat.copy(), own.eq_active.copy()],
            "commands": [self._planned.copy(), self._sent.copy(), self._said.copy()],
            "before": self._before,
            "past": copy.deepcopy(self._past),
            "told": self._told.copy(),
            "errors": self._errors.copy(),
            "filter": self._filter,
            "error": self._error,
            "times_lost": self.times_lost,
        }

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        own = self.data
        for array, remembered in zip(self._physics, state["physics"], strict=True):
            array[:] = remembered
        own.mocap_pos[:], own.mocap_quat[:], own.eq_active[:] = state["others"]
        self._planned[:], self._sent[:], said = state["commands"]
        self._said = said.copy()
        self._before = state["before"]
        self._past = copy.deepcopy(state["past"])
        self._told[:] = state["told"]
        self._errors = state["errors"].copy()
        if state["filter"] is not None:
            self._use(state["filter"])
        self._error = state["error"]
        self.times_lost = state["times_lost"]
        mujoco.mj_step1(self._model, own)


def _without_own_contacts(infant: DrivenInfant, model: mujoco.MjModel) -> mujoco.MjModel:
    """Return a model in which an infant's parts do not touch one another.

    Hands in the lap come and go: a forward model that has them on the wrong side of a contact errs by more than one
    that knows of none.
    """
    apart = copy.copy(model)
    apart.geom_contype[infant.is_own[model.geom_bodyid]] = 0
    return apart


def _tilt(felt_m_s2: FloatArray, foreseen_m_s2: FloatArray) -> FloatArray:
    """Return the rotation, shape (3,), in the frame of the head, by which it is tilted beyond what was foreseen."""
    sizes = np.linalg.norm(felt_m_s2), np.linalg.norm(foreseen_m_s2)
    if not all(MIN_SHARE_OF_G < size / GRAVITY_M_S2 < MAX_SHARE_OF_G for size in sizes):
        return np.zeros(3)
    return np.cross(felt_m_s2, foreseen_m_s2) / (sizes[0] * sizes[1])


def _heading_rad(quaternion: FloatArray) -> float:
    """Return the heading of a body by its leftward axis, which is level however the trunk is pitched."""
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, quaternion)
    leftward = rotation.reshape(3, 3)[:, 1]
    return float(np.arctan2(-leftward[0], leftward[1]))


WEIGHT_KG = {0: 3.3, 1: 4.3, 2: 5.4, 3: 6.1, 4: 6.7, 6: 7.6, 9: 8.6, 12: 9.3, 18: 10.6, 24: 11.8}
"""Mean weight by months, boys and girls (WHO growth standards 2006, medians)."""
WEEKS_PER_MONTH = 52.1775 / 12


def outgrown(infant: DrivenInfant, age_months: float, lag_weeks: float) -> mujoco.MjModel:
    """Return the model of a body that is as light as it was some weeks ago: what an infant takes its body to be.

    Only masses and inertias differ; by the mean weights of children.
    """
    ages = list(WEIGHT_KG)
    weights_kg = np.interp([age_months - lag_weeks / WEEKS_PER_MONTH, age_months], ages, list(WEIGHT_KG.values()))
    share = float(weights_kg[0] / weights_kg[1])
    lighter = copy.copy(infant.model)
    lighter.body_mass[infant.is_own] *= share
    lighter.body_inertia[infant.is_own] *= share
    mujoco.mj_setConst(lighter, mujoco.MjData(lighter))
    return lighter
