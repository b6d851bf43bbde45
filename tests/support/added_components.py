"""Components as others add them: a record with a spec, `build` and `bind` of each kind."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np
import pydantic
import trimesh

from mimoc.base.errors import UnknownToysError, suggestion
from mimoc.base.kinds import Component
from mimoc.compiler.actuation import ActuationSetup, Origin
from mimoc.compiler.mjcf.elements import Actuator, Furniture, Sensor, Site, WorldGeom, WorldMaterial
from mimoc.compiler.mjcf.scene import Placed
from mimoc.compiler.mjcf.world import Ground, ObjectBody, World
from mimoc.compiler.objects.built_object import BuiltObject, object_name, solid
from mimoc.compiler.scenes import SUN, BuiltScene
from mimoc.compiler.task_setup import TaskSetup
from mimoc.compiler.toys import Mesh, Solid, Toybox, assemble
from mimoc.runtime.actuation import Actuation, command_range, effort_of, find_actuators, limits_of_motors
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.noise import Noise
from mimoc.runtime.sense import Vector
from mimoc.runtime.task import Judgement, SquaredCommands, Task
from mimoc.runtime.term import Field, Term
from mimoc.schema.base import Model
from mimoc.schema.kinds import (
    ActuationKind,
    AgeTable,
    NoiseOption,
    ObjectKind,
    SceneKind,
    SenseKind,
    TaskKind,
    ToySource,
)
from mimoc.schema.objects import ObjectSpec
from mimoc.schema.quantities import Centimetres, Real
from mimoc.schema.task import TaskEntry, TaskSpec


def origin(value: Any, unit: str, source: str) -> dict[str, Any]:
    return {"value": value, "unit": unit, "rule": "given by the spec", "from": [source]}


# A task.


class LiftSpec(TaskSpec):
    """Lift a body; gravity is another in each episode."""

    kind: Literal["lift"]
    """Which task this is."""
    body: str = "head"
    """What is to be lifted."""


class LiftEntry(TaskEntry):
    """Lift a body."""

    kind: Literal["lift"] = "lift"
    """Which task this is."""
    body: str
    """What is to be lifted."""
    success_m: float = 0.3
    """Height of success."""


@dataclass(frozen=True)
class Lifted(Term):
    """The reward is the height of a body, less what the commands cost."""

    body: int
    success_m: float
    cost: SquaredCommands

    def __call__(self, worlds, action, memory):
        height_m = worlds.xpos[:, self.body, 2]
        terms = {"height": height_m, "effort": -self.cost(worlds, action)}
        return Judgement(terms, success=height_m > self.success_m)


class Lift(Task):
    """Gravity is another in each episode."""

    def __init__(self, entry, model, bundle):
        self._model, self._body = model, model.body(entry.body).id
        cost = SquaredCommands(*command_range(bundle.manifest.actuation))
        super().__init__(entry.steps, Lifted(self._body, entry.success_m, cost))

    @property
    def model_fields(self):
        return (ModelField("body_gravcomp", np.array([self._body])),)

    def start(self, data, generator):
        self._model.body_gravcomp[self._body] = generator.uniform()


LIFT = TaskKind(
    name="lift",
    spec=LiftSpec,
    entry=LiftEntry,
    build=lambda spec, tree: TaskSetup(LiftEntry(steps=spec.steps or 4, body=spec.body)),
    run=Lift,
    scenes=("flat",),
    poses=None,
    step_ms=20.0,
)

# A sense.


class HeightSpec(Model):
    """Height of the head above the floor."""

    max_m: Annotated[Real, pydantic.Field(gt=0, le=10)] = 2.0
    """Largest height that is observed."""


class HeightEntry(Model):
    """Height of the head above the floor."""

    kind: Literal["height"] = "height"
    """Which sense this is."""
    site: str
    """Site in the middle of the head."""
    max_m: float
    """Largest height that is observed."""


def build_height(spec, body) -> Placed:
    site = Site("height_site", body.geoms["head"].pos_m, 0.01)
    return Placed(
        HeightEntry(site=site.name, max_m=spec.max_m),
        sites={"head": (site,)},
        sensors=(Sensor("velocimeter", "height_velocity", site.name),),
        arrays={"marks_m": np.linspace(0, spec.max_m, 3)},
        origins={"height.max_m": origin(spec.max_m, "m", "spec.senses.height.max_m")},
    )


class Height(Vector):
    """Height of the head, shape (1,), [m]."""

    def __init__(self, site: int, max_m: float):
        super().__init__("height", layout=("head [m]",), low=0.0, high=max_m)
        self._site = site

    def __call__(self, data):
        return data.site_xpos[self._site, 2:].copy()


def bind_height(entry, model, bundle) -> Height:
    assert bundle.arrays["height/marks_m"].tolist() == [0, entry.max_m / 2, entry.max_m]
    assert model.sensor("height_velocity").objid[0] == model.site(entry.site).id
    return Height(model.site(entry.site).id, entry.max_m)


@dataclass(frozen=True)
class Blur(Noise):
    """As much too high or too low as drawn."""

    deviation_m: np.ndarray

    def __call__(self, draw, sample, state):
        return sample + self.deviation_m * draw.xp.sign(draw.normals(sample.shape)), None


def bind_blur(deviation_m: float, sense: Height, low_pass_s: float) -> Blur:
    assert (sense.name, low_pass_s) == ("height", 0.06)
    return Blur(np.array([deviation_m]))


HEIGHT = SenseKind(
    name="height",
    spec=HeightSpec,
    entry=HeightEntry,
    build=build_height,
    run=bind_height,
    physiological_delay=AgeTable((0.0, 24.0), ms=(60.0, 20.0), legs_ms=(80.0, 40.0)),
    noise=NoiseOption("m", "Error of the height, either way.", most=1.0, run=bind_blur),
)

# A scene.


class StepSpec(Model):
    """A step on the floor."""

    height_m: float = pydantic.Field(default=0.1, gt=0, le=1)
    """Of its top."""


def build_step(spec, occupant, wallpapers) -> BuiltScene:
    """Return a floor with a step two metres ahead; nothing of it depends on the infant, so no footprint is computed."""
    assert len(occupant.discs) == 0 or spec.toys
    half = spec.step.height_m / 2
    step = WorldGeom("step", "box", (0.2, 0.5, half), (2.0, 0.0, half), (0.0, 0.0, 0.0), "step")
    furniture = Furniture((step,), (WorldMaterial("step", (0.5, 0.4, 0.3, 1.0)),))
    world = World(grounds=(Ground("floor", 0.0),), lights=(SUN,), furniture=furniture)
    origins = {"step.height": origin(spec.step.height_m, "m", "spec.scene.step.height_m")}
    return BuiltScene(world, half_size_m=(1.7, 1.7), origins=origins)


STEP = SceneKind(
    name="step", about="A floor with a step.", build=build_step, spec=StepSpec, needs_footprint=False, varies=False
)

# A source of toys.


class BricksSpec(Model):
    """Toy bricks."""

    density_kg_m3: float = pydantic.Field(default=600.0, gt=0, le=5000)
    """Of their wood."""


def build_bricks(spec, folder) -> Toybox:
    """Return bricks of two lengths."""
    lengths = {"brick": 2.0, "plank": 5.0}
    unknown = [name for name in spec.subset if name not in lengths]
    if unknown:
        raise UnknownToysError({name: f"'{name}' is no brick; {suggestion(name, lengths)}" for name in unknown})

    def load(name):
        brick = trimesh.creation.box((lengths[name], 1.0, 1.0))
        looks = {"main": [Mesh(brick.vertices, brick.faces)]}
        return assemble(name, looks, [Solid("box", (lengths[name] / 2, 0.5, 0.5))], spec.bricks.density_kg_m3)

    return Toybox(tuple(sorted(spec.subset or lengths)), load, ("the bricks are made of wood",))


BRICKS = ToySource(name="bricks", about="Toy bricks.", build=build_bricks, spec=BricksSpec)

# An actuation model.


class WeakSpec(Model):
    """Motors with a share of their strength."""

    share: float = 0.5
    """Of the strength of torque motors."""


def weak_motors(spec, tree, timestep_s) -> ActuationSetup:
    """Return weak motors; only the first says where its numbers come from."""
    motors = tuple(
        Actuator(
            name=f"{motor.name}_weak",
            mimo_actuator=motor.name,
            joint=motor.joint,
            gear=spec.share * motor.gear_nm,
            control_range=(-1.0, 1.0),
            settings=(("forcerange", motor.force_range),),
        )
        for motor in tree.motors
    )
    defaults = (("forcelimited", "true"), ("gaintype", "fixed"), ("gainprm", "1"), ("biastype", "none"))
    origins = {f"actuator.{motors[0].name}.forcerange": Origin("as measured", ("spec.age_months",), "1")}
    return ActuationSetup(motors, defaults, "Euler", tree.joints, origins=origins)


def bind_weak(entry, model) -> Actuation:
    ids = find_actuators(entry, model)
    limits_nm, drive = limits_of_motors(model, ids), Field("ctrl", ids)
    return Actuation(ids, *command_range(entry), limits_nm, effort_of(Field("actuator_force", ids), limits_nm), drive)


WEAK = ActuationKind(name="weak", about="Weak motors.", build=weak_motors, run=bind_weak, spec=WeakSpec)


def tripled_motors(spec, tree, timestep_s) -> ActuationSetup:
    """Return motors of three times their strength, by their gain and without a force range."""
    motors = weak_motors(WeakSpec(share=1.0), tree, timestep_s).actuators
    defaults = (("forcelimited", "false"), ("gaintype", "fixed"), ("gainprm", "3"), ("biastype", "none"))
    return ActuationSetup(tuple(replace(motor, settings=()) for motor in motors), defaults, "Euler", tree.joints)


def bind_tripled(entry, model) -> Actuation:
    ids = find_actuators(entry, model)
    strengths_nm = 3 * model.actuator_gear[ids, 0]
    limits_nm, drive = np.stack([-strengths_nm, strengths_nm], axis=1), Field("ctrl", ids)
    return Actuation(ids, *command_range(entry), limits_nm, effort_of(drive, limits_nm), drive, "excitation")


TRIPLED = replace(WEAK, name="tripled", build=tripled_motors, run=bind_tripled, spec=None)

# An object.


class StoolSpec(ObjectSpec):
    """A stool."""

    kind: Literal["stool"]
    """Kind of object."""
    stool_cm: Annotated[Centimetres, pydantic.Field(ge=5, le=60)] = 20.0
    """Height of its seat."""


def build_stool(spec, surroundings) -> BuiltObject:
    """Return a block to sit on."""
    assert surroundings.tree.bodies
    name, half_m = object_name(spec.name), spec.stool_cm / 200
    geom = solid(name, name, "box", (0.1, 0.1, half_m), (0.0, 0.0, 0.0), 1.0)
    return BuiltObject(
        root=ObjectBody(name, pos_m=(0.0, 0.0, half_m), geoms=(geom,)),
        materials=(WorldMaterial(name, (0.5, 0.4, 0.3, 1.0)),),
        motion="fixed",
        material="wood",
        radius_m=0.15,
        height_m=2 * half_m,
        size_m=0.2,
        mass_kg=1.0,
        surface_m=(0.1, 0.1),
        origins={"seat": origin(2 * half_m, "m", "spec.scene.objects")},
    )


STOOL = ObjectKind("stool", "A stool.", StoolSpec, build_stool)


@dataclass(frozen=True)
class Added:
    """A record that is added, how a spec asks for it, and one number of its own."""

    record: Component
    plugin: str  # Its name in a manifest.
    keys: Mapping[str, Any]
    number: str
    told: str  # What the first line says that explains this number.


STOOL_AND_CUP = [
    {"name": "stool", "kind": "stool", "stool_cm": 12, "at": {"x_cm": 60}},
    {"name": "cup", "toy": "cup", "at": "on stool"},
]
TWO_TOYS = {"toys": {"count": [2, 2]}}
WOOD = {"source": "bricks", "count": [3, 3], "size_cm": [10, 10], "bricks": {"density_kg_m3": 500}}
ADDED = {
    "task": Added(LIFT, "tasks.lift", {"task": {"kind": "lift"}}, "task.lift.success_m", "0.3"),
    "sense": Added(HEIGHT, "senses.height", {"senses": {"height": {"max_m": 1.5}}}, "height.max_m", "1.5 m"),
    "scene": Added(
        STEP, "scenes.step", {"scene": {"kind": "step", "step": {"height_m": 0.2}, **TWO_TOYS}}, "step.height", "0.2 m"
    ),
    "toys": Added(
        BRICKS,
        "toys.bricks",
        {"scene": {"kind": "flat", "toys": WOOD}},
        "spec.scene.toys.bricks.density_kg_m3",
        "500",
    ),
    "actuation": Added(
        WEAK,
        "actuation.weak",
        {"age_months": 18, "actuation": {"model": "weak", "weak": {"share": 0.25}}},
        "spec.actuation.weak.share",
        "0.25",
    ),
    "object": Added(STOOL, "objects.stool", {"scene": {"objects": STOOL_AND_CUP}}, "object.stool.seat", "0.12 m"),
}
