"""What is reported of a motion that was followed: errors, torque needed over available, and what the trunk lacked."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mimoc.base.units import GRAVITY_M_S2
from mimoc.bundle.manifest import Manifest
from mimoc.policies.control.tracking import Body, Demand
from mimoc.runtime.sense import FloatArray


@dataclass(frozen=True)
class Followed:
    """A motion that was followed over t control steps by an infant with n joints that actuators move."""

    body: Body
    manifest: Manifest
    errors_rad: FloatArray
    """Of joint angles, shape (t, n)."""
    root_errors: FloatArray
    """Of the root's place [m] and orientation [rad], shape (t, 6); (t, 0) if it is held."""
    applied: FloatArray
    """Force [N] and torque [N m] that were applied at the root, shape (t, 6)."""
    demand: Demand
    headings = "joint", "error [°]", "torque needed / available", "95th percentile", "above 1", "known"
    """Of the columns of `rows`."""

    def metrics(self) -> dict[str, float]:
        """Return the numbers of a run, by name with unit; those of which there is nothing are left out."""
        if not len(self.errors_rad):
            return {}
        shares = np.array(self.demand.shares)
        metrics = dict(_of_joints("", self.errors_rad, shares))
        for group, members in self._groups():
            if members.any():
                metrics |= _of_joints(f"{group}_", self.errors_rad[:, members], shares[:, members])
        if self.root_errors.shape[1]:
            metrics |= self._of_root()
        return metrics

    def rows(self) -> list[tuple[str, ...]]:
        """Return a row for each joint.

        It has the joint's name, its error, the torque that it needs over what it has, median and 95th percentile, the
        share of the time that this is above 1, and the share of the time that it is known.
        """
        rows, shares = list[tuple[str, ...]](), np.array(self.demand.shares)
        for joint, name in enumerate(self.body.joints.names):
            known = shares[:, joint][np.isfinite(shares[:, joint])]
            needed = [f"{value:.2f}" for value in np.percentile(known, (50, 95))] if known.size else ["-", "-"]
            above = f"{100 * (known > 1).mean():.0f} %" if known.size else "-"
            error = f"{_rms_deg(self.errors_rad[:, joint]):.1f}"
            rows.append((name, error, *needed, above, f"{100 * known.size / len(shares):.0f} %"))
        return rows

    def _groups(self) -> Iterator[tuple[str, npt.NDArray[np.bool_]]]:
        """Yield which joints are reported together: those of both arms, of both legs, and each group of the midline."""
        yield from self.body.of_limbs.items()
        is_limbs = np.any([*self.body.of_limbs.values()], axis=0)
        for group, joints in self.manifest.anatomy.groups.items():
            own = [*map(self.manifest.of_infant, joints)]
            members = np.array([name in own for name in self.body.joints.names], bool)
            if not (members & is_limbs).any():
                yield group, members

    def _of_root(self) -> dict[str, float]:
        """Return the drift of the trunk, the wrench that it needs, and that which it got."""
        model = self.body.model
        weight_n = GRAVITY_M_S2 * float(model.body_subtreemass[self.body.root])
        away_m, turned_rad = (np.linalg.norm(self.root_errors[:, part], axis=1) for part in (PLACE, TURN))
        metrics = {"drift_m": float(away_m.max()), "drift_end_m": float(away_m[-1])}
        metrics["turned_deg"] = float(np.degrees(turned_rad.max()))
        for name, wrenches in (("wrench", np.array(self.demand.wrenches)), ("assisted", self.applied)):
            if not wrenches.any():
                continue
            force_n, torque_nm = (np.linalg.norm(wrenches[:, part], axis=1) for part in (PLACE, TURN))
            for size, value in (("median", 50), ("p95", 95)):
                metrics[f"{name}_force_{size}_n"] = round(float(np.percentile(force_n, value)), 9)
                metrics[f"{name}_force_{size}_weights"] = round(float(np.percentile(force_n, value)) / weight_n, 9)
                metrics[f"{name}_torque_{size}_nm"] = round(float(np.percentile(torque_nm, value)), 9)
        return metrics


PLACE, TURN = slice(0, 3), slice(3, 6)
"""Linear and angular part of a velocity or wrench of the root."""


def _of_joints(prefix: str, errors_rad: FloatArray, shares: FloatArray) -> Iterator[tuple[str, float]]:
    yield f"{prefix}error_deg", _rms_deg(errors_rad)
    known = shares[np.isfinite(shares)]
    if known.size:
        yield f"{prefix}torque_needed_median", float(np.median(known))
        yield f"{prefix}torque_needed_p95", float(np.percentile(known, 95))
        yield f"{prefix}torque_above_share", float((known > 1.0).mean())


def _rms_deg(errors_rad: FloatArray) -> float:
    return float(np.degrees(np.sqrt(np.mean(errors_rad**2))))
