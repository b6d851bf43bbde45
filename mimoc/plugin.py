"""All that the author of a plug-in needs, in one place: `from mimoc.plugin import Entry, SenseKind, Spec, Term`.

`dir(mimoc.plugin)` are the names. Each is imported from its home when it is first asked for, so that a record stays as
light as its own modules.
"""

from typing import TYPE_CHECKING

from mimoc.base.lazy import names_of

if TYPE_CHECKING:
    from mimoc.actuation.binding import Actuation as Actuation, effort_of as effort_of
    from mimoc.base.kinds import (
        ActuationKind as ActuationKind,
        AgeTable as AgeTable,
        ExporterKind as ExporterKind,
        MotionFormat as MotionFormat,
        NoiseOption as NoiseOption,
        ObjectKind as ObjectKind,
        PartKind as PartKind,
        PolicyKind as PolicyKind,
        SceneKind as SceneKind,
        SenseKind as SenseKind,
        TaskKind as TaskKind,
        ToySource as ToySource,
    )
    from mimoc.body.dimensions import BodyGeometry as BodyGeometry, GeomShape as GeomShape
    from mimoc.body.part import (
        ReferenceGeom as ReferenceGeom,
        ReferenceJoint as ReferenceJoint,
        ReferenceMotor as ReferenceMotor,
        ReferencePart as ReferencePart,
    )
    from mimoc.bundle.regular_files import UnusableFileError as UnusableFileError
    from mimoc.mjcf.furniture import Furniture as Furniture, WorldGeom as WorldGeom, WorldMaterial as WorldMaterial
    from mimoc.mjcf.scene import Placed as Placed
    from mimoc.mjcf.world import Ground as Ground, ObjectBody as ObjectBody, ObjectJoint as ObjectJoint, World as World
    from mimoc.motion.options import ReadOptions as ReadOptions
    from mimoc.motion.point_recording import Camera as Camera, PointRecording as PointRecording
    from mimoc.noise.noise import LowPass as LowPass, Noise as Noise, Smooth as Smooth
    from mimoc.objects.built_object import BuiltObject as BuiltObject, Surroundings as Surroundings
    from mimoc.objects.names import object_name as object_name
    from mimoc.objects.pieces import solid as solid
    from mimoc.objects.spec_base import ObjectSpec as ObjectSpec
    from mimoc.plugins import register as register
    from mimoc.quantities import Quantity as Quantity
    from mimoc.runtime.filter import Filter as Filter, Lags as Lags
    from mimoc.runtime.term import Concatenated as Concatenated, Field as Field, Term as Term
    from mimoc.runtime.term_contract import check_term as check_term
    from mimoc.runtime.worlds import Worlds as Worlds
    from mimoc.scenes.built_scene import SUN as SUN, BuiltScene as BuiltScene
    from mimoc.schema.base import Model as Entry, Model as Spec
    from mimoc.senses.custom import TermSense as TermSense
    from mimoc.senses.sense import Sense as Sense, Vector as Vector
    from mimoc.tasks.build_setup import TaskSetup as TaskSetup
    from mimoc.tasks.judgement import Change as Change, Judgement as Judgement, Verdict as Verdict
    from mimoc.tasks.spec_base import TaskEntry as TaskEntry, TaskSpec as TaskSpec
    from mimoc.tasks.task import Task as Task

__getattr__, __dir__, __all__ = names_of(__name__)
