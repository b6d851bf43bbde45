"""Speed of mimoc's five-finger body compared with the published one with its own solver settings.

    python benchmarks/published.py [--rounds 15]

The published body is put together here from its figures (tests/reference/five_finger), with what it is stepped
with: 5 ms, Newton, elliptic cones, dense Jacobian (growth.md, section 1). Both lie on their backs on the same
floor under the same random commands, in turn; wanted: 2.5 times.
"""

import argparse
import csv
import itertools
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.sax.saxutils import quoteattr

import mujoco
import numpy as np
from measuring import cpu_medians_s

import mimoc
from mimoc.bundle.model import load_model

FIGURES = Path(__file__).parents[1] / "tests" / "reference" / "five_finger"
STEPS = 400
CHEST = {"robot:chest_lean", "robot:chest_rot"}  # Left out: mimoc's body is measured without them too.

HEAD = """<mujoco><compiler angle="degree"/>
<option timestep="0.005" cone="elliptic" jacobian="dense" solver="Newton"/>
<default>
<joint limited="true" solreflimit="0.02 1" solimplimit="0.98 0.99 0.001 0.5 1"/>
<geom condim="3" friction="1 0.005 0.0002" solref="0.005 1" solimp="0.95 0.99 0.001 0.5 1"/>
</default>
"""


def main() -> None:
    """Print both rates and their ratio."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    spec = {"mimoc": 1, "name": "infant", "age_months": 18, "body": {"hands": "five_finger"}}
    ours = load_model(mimoc.build(mimoc.InfantSpec.model_validate(spec)))
    published = mujoco.MjModel.from_xml_string(published_xml())
    print(f"MuJoCo {mujoco.__version__}; published {published.nu} actuators, mimoc {ours.nu}")
    candidates = {"published": stepping(published), "mimoc": stepping(ours)}
    rates_hz = {name: STEPS / seconds for name, seconds in cpu_medians_s(candidates, rounds).items()}
    for name, rate_hz in rates_hz.items():
        print(f"{name:10} {rate_hz:6.0f} steps/s")
    print(f"ratio      {rates_hz['mimoc'] / rates_hz['published']:6.1f}")


def stepping(model: mujoco.MjModel) -> Callable[[], None]:
    """Return a function that steps a model for two seconds from its back; each call draws other commands."""
    seeds = itertools.count()

    def step() -> None:
        data, generator = mujoco.MjData(model), np.random.default_rng(next(seeds))
        data.qpos[:7] = (0, 0, 0.12, np.sqrt(0.5), 0, -np.sqrt(0.5), 0)
        for number in range(STEPS):
            if number % 2 == 0:
                data.ctrl[:] = generator.uniform(-1, 1, model.nu)
            mujoco.mj_step(model, data)

    return step


def published_xml() -> str:
    """Return the published body on a floor."""
    return "".join((HEAD, "<worldbody>", '<geom name="floor" type="plane" size="0 0 1"/>', *_bodies("world"), _rest()))


def _bodies(parent: str) -> Iterator[str]:
    for body in _rows("bodies"):
        if body["parent"] != parent:
            continue
        yield f"<body {_attributes(name=body['name'], pos=body['pos_m'], euler=body['euler_deg'])}>"
        yield '<freejoint name="free"/>' if parent == "world" else ""
        yield from (_joint(joint) for joint in _rows("joints") if joint["body"] == body["name"])
        yield from (_geom(geom) for geom in _rows("geoms") if geom["body"] == body["name"])
        yield from _bodies(body["name"])
        yield "</body>"


def _joint(row: dict[str, str]) -> str:
    if row["name"] in CHEST:
        return ""
    return "<joint {}/>".format(
        _attributes(
            name=row["name"],
            axis=row["axis"],
            pos=row["pos_m"],
            range=row["range_deg"],
            stiffness=row["stiffness_nm_per_rad"],
            damping=row["damping_nms_per_rad"],
            frictionloss=row["frictionloss_nm"],
            armature=row["armature_kgm2"],
            springref=row["springref_deg"],
        )
    )


def _geom(row: dict[str, str]) -> str:
    masks = {"contype": "0", "conaffinity": "0"} if row["name"] in {"cb", "neck"} else {}
    return "<geom {}/>".format(
        _attributes(
            name=row["name"],
            type=row["type"],
            size=row["size_m"],
            pos=row["pos_m"],
            euler=row["euler_deg"],
            mass=row["mass_kg"],
            friction=row["friction"],
            condim=row["condim"],
            **({"contype": row["contype"], "conaffinity": row["conaffinity"]} | masks),
        )
    )


def _rest() -> str:
    """Return everything behind the bodies: contacts, couplings, motors."""
    pairs = [row for row in _rows("contacts") if row["kind"] == "pair"]
    excludes = [row for row in _rows("contacts") if row["kind"] == "exclude"]
    motors = [row for row in _rows("actuators") if row["joint"] not in CHEST]
    return "".join(
        (
            "</worldbody><contact>",
            *(f"<pair {_attributes(geom1=r['first'], geom2=r['second'], condim=r['condim'])}/>" for r in pairs),
            *(f"<exclude {_attributes(body1=r['first'], body2=r['second'])}/>" for r in excludes),
            "</contact><tendon>",
            *map(_tendon, _rows("tendons")),
            "</tendon><actuator>",
            *map(_motor, motors),
            "</actuator></mujoco>",
        )
    )


def _tendon(row: dict[str, str]) -> str:
    terms = [term.split() for term in row["joint_coefficients"].split(";")]
    joints = "".join(f"<joint {_attributes(joint=joint, coef=coef)}/>" for joint, coef in terms)
    return f'<fixed limited="true" {_attributes(name=row["name"], range=row["range_rad"])}>{joints}</fixed>'


def _motor(row: dict[str, str]) -> str:
    limits = 'ctrllimited="true" ctrlrange="-1 1" forcelimited="true"'
    named = _attributes(name=row["name"], joint=row["joint"], gear=row["gear_nm"], forcerange=row["force_range"])
    return f"<motor {limits} {named}/>"


def _attributes(**values: str) -> str:
    return " ".join(f"{name}={quoteattr(value)}" for name, value in values.items() if value)


def _rows(name: str) -> list[dict[str, str]]:
    with (FIGURES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


if __name__ == "__main__":
    main()
