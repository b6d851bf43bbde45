"""Dynamics: the accelerations that an infant's joint torques cause, given its supports and joint limits.

With the mass matrix M, the bias forces h and the Jacobian J_c of the supports, the constrained equations of motion

    M q̈ + h = τ + J_cᵀ λ,   J_c q̈ = 0   (Mistry & Righetti 2012, without J̇_c q̇, as supports are at rest)

are solved in coordinates in which M is the identity: a row j of a Jacobian becomes y = D^-½ L^-ᵀ j with M = Lᵀ D L, so
that j M⁻¹ j'ᵀ = y y'ᵀ, and constraints remove the component of each y in the span of their own rows.
"""

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import UnknownNameError
from mimoc.bundle.manifest import AnatomyEntry, LimbEntry, Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.runtime.sense import FloatArray, IntArray

RANK = 1e-4
"""Threshold, relative to the size of a demand, below which singular values count as zero, since demands of higher
priority leave almost no freedom in these directions."""
DAMPING = 0.01  # Damping λ of inverses, relative to the size of the demand.
SINGULAR = 0.1  # Threshold, relative to the size of a demand, below which a singular value is damped more strongly.
SINGULAR_DAMPING = 0.3
"""Damping at singularities: a stretched arm then stays at rest instead of flailing at a target beyond its reach."""
_TINY = 1e-30
_STRIP = 2**17
"""Number of products above which BLAS distributes a multiplication over threads, whose start takes longer than it."""


@dataclass(frozen=True, slots=True)
class LinearDemand:
    """Accelerations demanded at one priority, as a linear function of n torques (fractions of strength)."""

    response: FloatArray  # Acceleration per unit of each torque, shape (m, n).
    accelerations: FloatArray  # Demanded accelerations less those without torques, shape (m,).

    @property
    def size(self) -> float:
        """Frobenius norm of the response, the reference for singular values."""
        return size_of(self.response)


def size_of(matrix: FloatArray) -> float:
    """Return the Frobenius norm of a matrix."""
    return math.sqrt(np.vdot(matrix, matrix))


def joined(demands: Sequence[LinearDemand]) -> LinearDemand:
    """Return one demand of several, each normalised by its size, so that metres and radians are comparable."""
    if len(demands) == 1:
        return demands[0]
    sizes = [max(demand.size, _TINY) for demand in demands]
    return LinearDemand(
        np.concatenate([demand.response / size for demand, size in zip(demands, sizes, strict=True)]),
        np.concatenate([demand.accelerations / size for demand, size in zip(demands, sizes, strict=True)]),
    )


def solve_prioritized(demands: Sequence[LinearDemand], rest: LinearDemand) -> FloatArray:
    """Return the torques, shape (n,), that fulfil demands in order of priority.

    With the response A_k and the null-space projector N_k of the first k demands,
    u_k = u_(k-1) + (A_k N_(k-1))^# (a_k - A_k u_(k-1)), where ^# is a damped inverse. N_k is not damped, so that no
    demand disturbs those before it, regardless of the damping. The last demand is for the remaining freedom, and the
    size of its response is 1.
    """
    count = rest.response.shape[1]
    shares, taken = np.zeros(count), np.zeros((0, count))
    for demand in demands:
        values, left, right = _singular_values(_without(taken, demand.response), size := demand.size)
        missing = demand.accelerations - demand.response @ shares
        shares = shares + (damped_inverse(values, size) * (missing @ left)) @ right
        taken = np.concatenate([taken, right])
    # For the last demand, the null space need not be updated.
    free = _without(taken, rest.response)
    gram = product(free, free)
    gram.flat[:: len(gram) + 1] += DAMPING**2
    change = np.linalg.solve(gram, rest.accelerations - rest.response @ shares) @ free
    return shares + (change - (taken @ change) @ taken)


def damped_inverse(values: FloatArray, size: float) -> FloatArray:
    """Return s / (s² + λ²) of positive singular values s, shape (k,), of which the size of the demand is a bound.

    λ grows near singularities, so that it stays bounded.
    """
    nearness = np.maximum(1.0 - values / (SINGULAR * size), 0.0)
    return values / (values**2 + size**2 * (DAMPING**2 + (SINGULAR_DAMPING * nearness) ** 2))


def product(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return left rightᵀ of two matrices, shapes (m, k) and (n, k), in blocks."""
    height = max(1, _STRIP // max(1, right.size))
    if len(left) <= height:
        return left @ right.T
    return np.concatenate([left[top : top + height] @ right.T for top in range(0, len(left), height)])


def _singular_values(response: FloatArray, size: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the k singular values of a response above the threshold, and their vectors, shapes (m, k) and (k, n).

    They are computed from the eigenvalues of its Gram matrix, which for few rows takes a third of the time.
    """
    squares, left = np.linalg.eigh(response @ response.T)
    kept = squares > max((RANK * size) ** 2, _TINY)
    values, left = np.sqrt(squares[kept]), left[:, kept]
    return values, left, (left / values).T @ response


def _without(taken: FloatArray, response: FloatArray) -> FloatArray:
    """Return the component of a response that is orthogonal to *taken*, whose rows are orthonormal."""
    return response - (response @ taken.T) @ taken if len(taken) else response


X_AXIS, VIEW = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0])
"""Pointing axes: x for bodies of infants, and -z for MuJoCo's cameras."""

KINDS = {
    "site": (mujoco.mjtObj.mjOBJ_SITE, "site_bodyid", "site_xpos", "site_xmat", X_AXIS),
    "camera": (mujoco.mjtObj.mjOBJ_CAMERA, "cam_bodyid", "cam_xpos", "cam_xmat", VIEW),
    "body": (mujoco.mjtObj.mjOBJ_BODY, None, "xipos", "xmat", X_AXIS),
}
"""By what a name can be the name of, in the order of looking: where MuJoCo keeps its body, place and axes, and which
way it points. A body is where its centre of mass is, which of a hand is its palm."""


@dataclass(frozen=True, slots=True)
class Motion:
    """Pose and motion of a frame, in the world."""

    place_m: FloatArray  # Shape (3,).
    axes: FloatArray  # Its axes as columns, shape (3, 3).
    pointing: FloatArray  # Its pointing axis, in its own frame, shape (3,).
    velocity: FloatArray  # Linear, then angular velocity, shape (6,), [m/s, rad/s].
    jacobian: FloatArray  # Jacobian of that velocity, shape (6, nv).
    drift: FloatArray  # Its derivative at zero joint acceleration, shape (6,), [m/s², rad/s²].


@dataclass(frozen=True, slots=True)
class Frame:
    """A site, a camera or a body."""

    kind: str
    index: int  # Index in the model, among its kind.
    body: int  # Index of the body that it is attached to.

    def place_m(self, data: mujoco.MjData) -> FloatArray:
        """Return its position in the world, shape (3,), [m]."""
        return getattr(data, KINDS[self.kind][2])[self.index]

    def motion(self, model: mujoco.MjModel, data: mujoco.MjData) -> Motion:
        """Return its pose and motion; *data* must be up to date with its positions and velocities."""
        _, _, _, axes, pointing = KINDS[self.kind]
        place_m = self.place_m(data)
        rates = np.empty((12, model.nv))
        mujoco.mj_jac(model, data, rates[:3], rates[3:6], place_m, self.body)
        mujoco.mj_jacDot(model, data, rates[6:9], rates[9:], place_m, self.body)
        velocity_and_drift = rates @ data.qvel
        return Motion(
            place_m=place_m.copy(),
            axes=getattr(data, axes)[self.index].reshape(3, 3).copy(),
            pointing=pointing,
            velocity=velocity_and_drift[:6],
            jacobian=rates[:6],
            drift=velocity_and_drift[6:],
        )


def find_frame(name: str, model: mujoco.MjModel, prefix: str = "") -> Frame:
    """Return the site, camera or body of this name, in this order of precedence, or raise an UnknownNameError.

    The name is that in the model, or, of a part of the infant, without *prefix*; these come first.
    """
    for full_name in dict.fromkeys((prefix + name, name)):
        for kind, (object_type, bodies, *_) in KINDS.items():
            index = mujoco.mj_name2id(model, object_type, full_name)
            if index >= 0:
                return Frame(kind, index, int(getattr(model, bodies)[index]) if bodies else index)
    sites = [model.site(index).name for index in range(model.nsite)]
    cameras = [model.camera(index).name for index in range(model.ncam)]
    names = [*sites, *cameras, *(model.body(index).name for index in range(1, model.nbody))]
    raise UnknownNameError("site, camera or body of this infant", name, names)


def trunk_of(anatomy: AnatomyEntry, model: mujoco.MjModel) -> tuple[int, ...]:
    """Return the bodies of the trunk, from the first to the last."""
    return tuple(model.body(name).id for name in anatomy.trunk)


def limb_of(body: int, trunk: Collection[int], model: mujoco.MjModel) -> int:
    """Return the first body of the limb that a body belongs to; 0, the world, for bodies that are not in a limb."""
    while body not in trunk and body:
        parent = int(model.body_parentid[body])
        if parent in trunk:
            return body
        body = parent
    return 0


def joints_between(model: mujoco.MjModel, body: int, root: int) -> list[int]:
    """Return the joints that move a body relative to the parent of *root*, its ancestor or itself."""
    joints: list[int] = []
    while True:
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        joints = [*range(first, first + count), *joints]
        if body == root:
            return joints
        body = int(model.body_parentid[body])


def arms_with_hands(anatomy: AnatomyEntry, model: mujoco.MjModel) -> Iterator[tuple[LimbEntry, int, list[int]]]:
    """Yield each arm that ends in a hand, the body of the hand, and the joints from the shoulder to the wrist."""
    for limb in anatomy.arms:
        if limb.end:
            hand = model.body(limb.end).id
            yield limb, hand, joints_between(model, hand, model.body(limb.root).id)


REDUNDANT = 1e-9  # Relative size below which a constraint counts as redundant, as when a body has many contact points.


@dataclass(frozen=True, slots=True)
class Dynamics:
    """The dynamics in one state, in coordinates in which the mass matrix is the identity."""

    model: mujoco.MjModel
    data: mujoco.MjData
    scales: FloatArray  # D^-½, shape (1, nv).
    torques: FloatArray  # Acceleration per torque of each joint without supports, shape (n, nv).
    free_torques: FloatArray  # Acceleration per torque of each joint with supports, shape (n, nv).
    drift: FloatArray  # Acceleration without any torque, shape (nv,).

    def response(self, jacobian: FloatArray, strength_nm: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the accelerations of m velocities by their Jacobian, shape (m, nv).

        Returns:
            Accelerations at full strength of each joint, with and without supports, shape (m, n) each, and without any
            torque, shape (m,).
        """
        rows = halved(self.model, self.data, self.scales, jacobian)
        return rows @ self.free_torques.T * strength_nm, rows @ self.torques.T * strength_nm, rows @ self.drift

    def joint_limit(self, strength_nm: FloatArray) -> "JointLimit":
        """Return the accelerations of the n joints that torques act on, of which these are the largest, shape (n,)."""
        response = product(self.torques, self.free_torques) * strength_nm
        unheld = np.einsum("ij,ij->i", self.torques, self.torques) * strength_nm
        return JointLimit(response, self.torques @ self.drift, unheld)


def dynamics(model: mujoco.MjModel, data: mujoco.MjData, speeds: IntArray, supports: FloatArray) -> Dynamics:
    """Return the dynamics in a state after `mj_forward`, with the actuators at rest.

    Each torque acts on one of the velocities, of indices *speeds*, shape (n,); the supports are their Jacobian, shape
    (m, nv).
    """
    scales = np.sqrt(data.qLDiagInv)[None]
    force = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
    count = len(speeds)
    unsolved = np.zeros((count + 1 + len(supports), model.nv))
    unsolved[np.arange(count), speeds] = 1.0
    unsolved[count] = force
    unsolved[count + 1 :] = supports
    rows = halved(model, data, scales, unsolved)
    moved = _unheld(rows[: count + 1], rows[count + 1 :])
    return Dynamics(model, data, scales, rows[:count], moved[:count], moved[count])


def _unheld(moved: FloatArray, held: FloatArray) -> FloatArray:
    """Return the component of motions, shape (n, nv), that the supports, shape (m, nv), allow."""
    sizes = np.sqrt(np.einsum("ij,ij->i", held, held))
    moving = sizes > 0.0  # A weld that leaves rotations free has rows of zeros.
    if not moving.any():
        return moved
    held = held[moving] / sizes[moving, None]
    gram = held @ held.T
    gram.flat[:: len(gram) + 1] += REDUNDANT
    forces = np.asarray(np.linalg.solve(gram, product(held, moved)), np.float64)
    return moved - product(forces.T, held.T)


def halved(model: mujoco.MjModel, data: mujoco.MjData, scales: FloatArray, rows: FloatArray) -> FloatArray:
    """Return rows, shape (m, nv), in coordinates in which the mass matrix is the identity."""
    result = np.empty_like(rows)
    mujoco.mj_solveM2(model, data, result, rows, scales)
    return result


HELD = 1e-3
"""Ratio of a joint's response with supports to that without, below which it counts as held, such as a locked joint."""
SLACK = 1e-6  # Tolerance by which a joint may exceed a bound, relative to its response to full strength.
MIN_RESPONSE = 1e-9  # Response to full strength below which a joint counts as having no strength, [rad/s²].


@dataclass(frozen=True, slots=True)
class JointLimit:
    """Accelerations of n joints as a function of their torques (fractions of strength)."""

    response: FloatArray  # Acceleration of each joint per unit of each torque, shape (n, n), [rad/s²].
    drift: FloatArray  # Acceleration without torques, shape (n,), [rad/s²].
    unheld: FloatArray  # Acceleration of each joint at its own full strength without supports, shape (n,), [rad/s²].

    def demand(self, joints: Sequence[int] | IntArray, accelerations: FloatArray) -> LinearDemand:
        """Return a demand for accelerations of some joints, each normalised by its own response.

        Joints that are held by the world are omitted.
        """
        sizes = np.where(self.free[joints], self.unheld[joints], np.inf)
        return LinearDemand(self.response[joints] / sizes[:, None], (accelerations - self.drift[joints]) / sizes)

    @property
    def free(self) -> npt.NDArray[np.bool_]:
        """Mask of the joints that are not held by the world and have some strength, shape (n,)."""
        return self.response.diagonal() > np.maximum(HELD * self.unheld, MIN_RESPONSE)


def solve_within_limits(
    turning: JointLimit, least: FloatArray, largest: FloatArray, demands: Sequence[LinearDemand], rest: LinearDemand
) -> FloatArray:
    """Return the torques, shape (n,), that fulfil demands in order as far as all joints stay within their bounds.

    The bounds are the least and the largest acceleration of each, shape (n,), [rad/s²]; see `solve_prioritized`. If the
    torques would move joints beyond their bounds, these bounds become demands of the highest priority, and torques are
    computed a second time; more passes gain nothing.
    """
    shares = solve_prioritized(demands, rest)
    slack = SLACK * turning.unheld
    coming = turning.response @ shares + turning.drift
    beyond = np.flatnonzero(turning.free & ((coming > largest + slack) | (coming < least - slack)))
    if not beyond.size:
        return shares
    stops = np.clip(coming, least, largest)[beyond]
    return solve_prioritized([turning.demand(beyond, stops), *demands], rest)


_TYPES = mujoco.mjtConstraint
_EQUALITY, _TENDON_END = int(_TYPES.mjCNSTR_EQUALITY), int(_TYPES.mjCNSTR_LIMIT_TENDON)
_FIRST_CONTACT = int(_TYPES.mjCNSTR_CONTACT_FRICTIONLESS)  # First of MuJoCo's constraint types that are contacts.
MAX_PLAY_RAD = 0.05
"""Range below which a tendon couples its joints, as in the spine (0.02 rad); with a wider one, it only limits them."""
ON_CONE = 1.0 - 1e-6  # Share of the largest friction from which on a contact counts as sliding.
_STICKING = int(mujoco.mjtConstraintState.mjCNSTRSTATE_QUADRATIC)


class ContactConstraints:
    """Finds the rows of MuJoCo's constraints that hold the infant.

    These are all welds and locks, the couplings of the joints of the spine, limits of other tendons, such as those of
    the neck, and sticking contacts with static geoms; of the contacts of loose bodies only the normals. Contacts of
    limbs that objectives control are excluded, because they would prevent the demanded motion; so are dry friction,
    which yields, and joint limits, which are one-sided.
    """

    def __init__(self, model: mujoco.MjModel, manifest: Manifest, effectors: Iterable[int], loose: Iterable[int] = ()):
        """Find the bodies that can support the infant; *loose* ones, and those on them, may slide."""
        self._model = model
        self._couplings = _couplings(model)
        self._has_others = bool(manifest.prefix)
        bearing = model.body_rootid == model.body(manifest.root_body).id
        trunk = trunk_of(manifest.anatomy, model)
        busy = {limb_of(effector, trunk, model) for effector in effectors} - {0}
        bearing &= ~in_subtrees(model, list(busy))
        sliding = in_subtrees(model, list(loose))
        still = model.body_weldid == 0
        # The last entries are for constraints without geoms.
        self._bearing = np.append((bearing & ~sliding)[model.geom_bodyid], False)
        self._sliding = np.append((bearing & sliding)[model.geom_bodyid], False)
        self._still = np.append(still[model.geom_bodyid], False)

    def rows(self, data: mujoco.MjData) -> IntArray:
        """Return the constraints that hold the infant, shape (m,); *data* must have the solver's forces."""
        kinds = data.efc_type
        is_sticking = _sticking_by_force(data) if self._has_others else data.efc_state == _STICKING
        holding = kinds == _EQUALITY
        holding |= (kinds == _TENDON_END) & is_sticking
        contacts = np.flatnonzero((kinds >= _FIRST_CONTACT) & is_sticking)
        if len(contacts):
            geoms = data.contact.geom[data.efc_id[contacts]]
            holding[contacts] = self._on_static(self._bearing, geoms)
        holding[self._normals(data)] = True
        return np.flatnonzero(holding)

    def jacobian(self, data: mujoco.MjData) -> FloatArray:
        """Return the Jacobian of the constraints that hold the infant, shape (m, nv)."""
        rows = self.rows(data)
        if not mujoco.mj_isSparse(self._model):
            held = data.efc_J.reshape(data.nefc, self._model.nv)[rows]
            return np.concatenate([self._couplings, held])
        count = len(self._couplings)
        dense = np.zeros((count + len(rows), self._model.nv))
        dense[:count] = self._couplings
        if len(rows):
            lengths, starts = data.efc_J_rownnz[rows], data.efc_J_rowadr[rows]
            mujoco.mju_sparse2dense(dense[count:], data.efc_J, lengths, starts, data.efc_J_colind)
        return dense

    def _normals(self, data: mujoco.MjData) -> IntArray:
        """Return the constraints with which loose bodies press on static geoms, shape (k,).

        With the elliptic friction cones of bundles the first constraint of a contact is its normal.
        """
        first = data.contact.efc_address
        pressing = (first >= 0) & self._on_static(self._sliding, data.contact.geom)
        pressing[pressing] = data.efc_force[first[pressing]] > 0.0
        return first[pressing]

    def _on_static(self, ours: npt.NDArray[np.bool_], geoms: IntArray) -> npt.NDArray[np.bool_]:
        return np.logical_or.reduce(ours[geoms] & self._still[geoms[:, ::-1]], axis=1)


def _sticking_by_force(data: mujoco.MjData) -> npt.NDArray[np.bool_]:
    """Return which constraints act and are not those of sliding contacts, whose forces f are on the cone |f_t/μ| = f_n.

    It is what `efc_state` says, but where MuJoCo solves for several islands, as with several infants: then, that does
    not stand in the order of the constraints (MuJoCo 3.17).
    """
    contacts, force = data.contact, data.efc_force
    is_sticking = force != 0.0
    for first, size, friction in zip(contacts.efc_address, contacts.dim, contacts.friction, strict=True):
        if first >= 0:
            across = np.linalg.norm(force[first + 1 : first + size] / friction[: size - 1])
            is_sticking[first : first + size] = across < ON_CONE * force[first]
    return is_sticking


def _couplings(model: mujoco.MjModel) -> FloatArray:
    """Return the Jacobian of the tendons that couple joints, shape (m, nv)."""
    play_rad = np.diff(model.tendon_range, axis=1)[:, 0]
    tendons = np.flatnonzero((model.tendon_limited != 0) & (play_rad < MAX_PLAY_RAD))
    couplings = np.zeros((len(tendons), model.nv))
    for row, tendon in zip(couplings, tendons, strict=True):
        first = model.tendon_adr[tendon]
        wraps = np.arange(first, first + model.tendon_num[tendon])
        row[model.jnt_dofadr[model.wrap_objid[wraps]]] = model.wrap_prm[wraps]
    return couplings
