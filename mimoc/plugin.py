"""All that the author of a plug-in needs, in one place: `from mimoc.plugin import Entry, SenseKind, Spec, Term`.

`dir(mimoc.plugin)` are the names. Each is imported from its home when it is first asked for, so that a record stays as
light as its own modules.
"""

from typing import TYPE_CHECKING

from mimoc.base.lazy import names_of

if TYPE_CHECKING:
    from mimoc.anatomy.part import (
        BodyGeometry as BodyGeometry,
        GeomShape as GeomShape,
        PartKind as PartKind,
        ReferenceGeom as ReferenceGeom,
        ReferenceJoint as ReferenceJoint,
        ReferenceMotor as ReferenceMotor,
        ReferencePart as ReferencePart,
    )
    from mimoc.base.quantities import Quantity as Quantity
    from mimoc.bundle.regular_files import UnusableFileError as UnusableFileError
    from mimoc.compiler.mjcf.elements import (
        Furniture as Furniture,
        WorldGeom as WorldGeom,
        WorldMaterial as WorldMaterial,
    )
    from mimoc.compiler.mjcf.scene import Placed as Placed
    from mimoc.compiler.mjcf.world import (
        Ground as Ground,
        ObjectBody as ObjectBody,
        ObjectJoint as ObjectJoint,
        World as World,
    )
    from mimoc.compiler.objects.built_object import (
        BuiltObject as BuiltObject,
        Surroundings as Surroundings,
        object_name as object_name,
        solid as solid,
    )
    from mimoc.compiler.scenes import SUN as SUN, BuiltScene as BuiltScene
    from mimoc.compiler.task_setup import TaskSetup as TaskSetup
    from mimoc.motion.point_recording import (
        Camera as Camera,
        PointRecording as PointRecording,
        ReadOptions as ReadOptions,
    )
    from mimoc.runtime.actuation import Actuation as Actuation, effort_of as effort_of
    from mimoc.runtime.contract import check_term as check_term
    from mimoc.runtime.filter import Filter as Filter, Lags as Lags
    from mimoc.runtime.noise import LowPass as LowPass, Noise as Noise, Smooth as Smooth
    from mimoc.runtime.sense import Sense as Sense, TermSense as TermSense, Vector as Vector
    from mimoc.runtime.task import Change as Change, Judgement as Judgement, Task as Task, Verdict as Verdict
    from mimoc.runtime.term import Concatenated as Concatenated, Field as Field, Term as Term
    from mimoc.runtime.worlds import Worlds as Worlds
    from mimoc.schema.base import Model as Entry, Model as Spec
    from mimoc.schema.kinds import (
        ActuationKind as ActuationKind,
        AgeTable as AgeTable,
        ExporterKind as ExporterKind,
        MotionFormat as MotionFormat,
        NoiseOption as NoiseOption,
        ObjectKind as ObjectKind,
        PolicyKind as PolicyKind,
        SceneKind as SceneKind,
        SenseKind as SenseKind,
        TaskKind as TaskKind,
        ToySource as ToySource,
    )
    from mimoc.schema.objects import ObjectSpec as ObjectSpec
    from mimoc.schema.plugins import register as register
    from mimoc.schema.task import TaskEntry as TaskEntry, TaskSpec as TaskSpec

__getattr__, __dir__, __all__ = names_of(__name__)
