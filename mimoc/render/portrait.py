"""Pictures of infants: one in a pose, one among its toys, or several in a row."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from mimoc.base.errors import MimocError, RenderingError, check_name
from mimoc.base.geometry.rotations import FloatArray, matrix_from_axis
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees, load_model, load_posed
from mimoc.bundle.world import WorldBundle
from mimoc.render.body_camera import BodyCamera, Markers, company, join_markers, view_of_scene
from mimoc.render.camera import (
    FILLED,
    FILLED_BY_HEAD,
    FOVY_DEG,
    FROM_ABOVE,
    FROM_THE_FRONT,
    FROM_THE_SIDE,
    MARGIN,
    View,
    portrait_view,
    view_of_body,
    view_of_head,
)
from mimoc.render.picture_files import tile_pictures, with_scale_bar
from mimoc.render.picture_poses import (
    load_in_pose,
    load_world_in_pose,
    pose_in_picture,
    poses_in_pictures,
    state_in_pose,
)
from mimoc.render.renderer import Picture, Shown
from mimoc.render.soft_light import ROW, STILL, Exposure

ROW_FOVY_DEG = 10.0  # For infants in a row: from so far away that those at the ends do not turn their faces.


@dataclass(frozen=True, slots=True)
class Framing:
    """Where the camera of a picture stands, and what is around the infants; None is what suits their poses."""

    azimuth_deg: float | None = None
    """Around an infant, or a row: 0 is from its front, 90 from its left; one that lies on its back is seen from beyond
    its feet at 0, one on its belly from beyond its head."""
    elevation_deg: float | None = None  # Above the horizontal; 90 is from straight above.
    distance_m: float | None = None  # From the middle of what is shown; without one, all of it fills the picture.
    transparent: bool = False  # Whether only the infants are drawn, without a background or shadows.
    scale_bar: bool = False
    """Whether a bar says how long something is that is as far away as the middle of the infants."""
    crop: Literal["head"] | None = None  # Whether the head alone fills the picture.

    def view(self, usual: View, front_deg: float) -> View:
        """Return the direction to look in, given the one that suits the pose and that of looking at the front."""
        azimuth, elevation = usual
        if self.azimuth_deg is not None:
            azimuth = front_deg + self.azimuth_deg
        return azimuth, elevation if self.elevation_deg is None else -self.elevation_deg


def portrait(
    bundle: Bundle,
    pose: str | None = None,
    width: int = 640,
    height: int = 480,
    markers: Markers | None = None,
    shown: Shown = "skin",
    framing: Framing = Framing(),
) -> Picture:
    """Return a picture of an infant in a pose, shape (height, width, 3), or (height, width, 4) if transparent.

    The pose is a keyframe, by default the bundle's own; markers are drawn on top of it, such as the points of its skin.
    Raises an UnknownNameError for an unknown pose, a RenderingError without OpenGL.
    """
    (picture,) = portraits(bundle, [pose], width, height, markers, shown, framing)
    return picture


def portraits(
    bundle: Bundle,
    poses: Sequence[str | None],
    width: int = 640,
    height: int = 480,
    markers: Markers | None = None,
    shown: Shown = "skin",
    framing: Framing = Framing(),
) -> Iterator[Picture]:
    """Yield pictures of an infant in several poses, in less time than one after another takes; see `portrait`."""
    model, manifest = load_model(bundle), bundle.manifest
    root, head = manifest.root_body, manifest.anatomy.head
    states = [state_in_pose(bundle, model, pose) for pose in poses]
    beside = () if framing.crop else company(manifest, [root], states[0])
    margin = MARGIN if beside else 1 / (FILLED_BY_HEAD if framing.crop else FILLED)
    style = _Style((width, height), shown, framing)
    with closing(style.open(model, [root], margin=margin, beside=beside)) as camera:
        for data in states:
            subject = _subject(manifest, framing)
            front_deg, _ = view_of_body(FROM_THE_FRONT, data, root)
            if framing.crop:
                usual = view_of_head(data, subject)
            elif isinstance(manifest, Manifest) and manifest.caregiver:
                usual = view_of_scene(FROM_THE_SIDE, manifest, [root], data)
            else:
                usual = portrait_view(data, root, head)
            camera.view = framing.view(usual, front_deg)
            yield style.draw(camera, data, [subject], markers, is_tight=not beside)


@dataclass(frozen=True, slots=True)
class _Style:
    """How the pictures of infants that stand still are drawn."""

    size_px: tuple[int, int]
    shown: Shown
    framing: Framing
    fovy_deg: float = FOVY_DEG
    exposure: Exposure = STILL

    def open(
        self,
        model: mujoco.MjModel,
        roots: Sequence[str],
        view: View = FROM_THE_SIDE,
        *,
        margin: float = MARGIN,
        beside: Sequence[str] = (),
    ) -> BodyCamera:
        """Open the camera for pictures of some bodies; see `BodyCamera`."""
        return BodyCamera(
            model,
            roots,
            *self.size_px,
            view,
            fovy_deg=self.fovy_deg,
            exposure=self.exposure,
            margin=margin,
            shown=self.shown,
            cut_out=self.framing.transparent,
            beside=beside,
            static_materials=True,
        )

    def draw(
        self,
        camera: BodyCamera,
        data: mujoco.MjData,
        bodies: Sequence[str],
        markers: Markers | None,
        *,
        is_tight: bool = False,
    ) -> Picture:
        """Return a picture of bodies; tight ones leave out what only might be drawn."""
        if len(bodies) == 1 and self.framing.azimuth_deg is None:
            camera.turn(data)
        shot = camera.shot(data, camera.drawn(data, bodies) if is_tight else None)
        if self.framing.distance_m is not None:
            shot = shot.from_distance(self.framing.distance_m, self.fovy_deg)
        picture = camera.render(data, markers, shot)
        return with_scale_bar(picture, shot.px_per_m(len(picture))) if self.framing.scale_bar else picture


def _subject(manifest: Manifest, framing: Framing) -> str:
    if not framing.crop:
        return manifest.root_body
    if manifest.anatomy.head is None:
        raise RenderingError(f"'{manifest.name}' has no head to draw; leave out --crop head")
    return manifest.anatomy.head


def world_portrait(
    bundle: WorldBundle,
    pose: str | None = None,
    width: int = 640,
    height: int = 480,
    markers: Markers | None = None,
    shown: Shown = "skin",
    framing: Framing = Framing(),
) -> Picture:
    """Return a picture of several infants in their world, by default as they start; see `portrait`.

    Raises:
        UnknownNameError: If an infant cannot have the pose, a start pose of all.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_world_in_pose(bundle, pose)
    roots = [infant.manifest.root_body for infant in bundle.infants.values()]
    front_deg, _ = view_of_body(FROM_THE_FRONT, data, roots[0])
    view = framing.view(view_of_scene(FROM_THE_SIDE, bundle.manifest, roots, data), front_deg)
    beside = company(bundle.manifest, roots, data)
    style = _Style((width, height), shown, framing)
    with closing(style.open(model, roots, view, beside=beside)) as camera:
        return style.draw(camera, data, roots, markers)


def lineup(
    bundles: Sequence[Bundle],
    pose: str | None = None,
    width: int = 640,
    height: int = 480,
    markers: Sequence[Markers] | None = None,
    shown: Shown = "skin",
    framing: Framing = Framing(),
) -> Picture:
    """Return a picture of several infants in a row, to scale, shape (height, width, 3), or (..., 4) if transparent.

    They face the same way on a plain floor, whatever their scenes are, from the left; markers are drawn where they
    would be if each were alone. Raises what `portrait` does.
    """
    row = row_of(bundles, pose)
    drawn = None
    if markers is not None:
        drawn = join_markers(marker.moved(move.points_m) for marker, move in zip(markers, row.moves, strict=True))
    azimuth, _ = FROM_THE_FRONT
    steepest = min(view_of_body(FROM_THE_FRONT, row.data, root)[1] for root in row.roots)
    view = framing.view((azimuth, steepest), azimuth)
    style = _Style((width, height), shown, framing, ROW_FOVY_DEG, ROW)
    with closing(style.open(row.data.model, row.roots, view)) as camera:
        return style.draw(camera, row.data, row.roots, drawn)


def overview(bundle: Bundle, width: int = 320, height: int = 240) -> Picture:
    """Return a picture of an infant and its toys, from within the room, shape (height, width, 3).

    Raises:
        ModelError: If MuJoCo rejects the model.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_posed(bundle)
    root, toys = bundle.manifest.root_body, bundle.manifest.toys
    shown = [root, *(toy.body for toy in toys)]
    view = view_of_scene(FROM_ABOVE, bundle.manifest, [root], data)
    beside = company(bundle.manifest, [root], data)
    with closing(
        BodyCamera(model, shown, width, height, view, exposure=STILL, beside=beside, static_materials=True)
    ) as camera:
        camera.turn(data)
        return camera.render(data)


GAP_M = 0.06  # Between one infant and the next.
UP = (0.0, 0.0, 1.0)
NAME_BYTES = 40  # For the name of a body in MuJoCo's file of a skin.
FLOOR = """
<mujoco model="row">
  <statistic center="0 0 0.3" extent="1"/>
  <visual>
    <quality numslices="48" numstacks="32"/>
    <map znear="0.005" zfar="60"/>
  </visual>
  <asset>
    <texture name="sky" type="skybox" builtin="flat" width="32" height="192"/>
    <texture name="mat" type="2d" builtin="checker" width="64" height="64" rgb1="0.93 0.91 0.86" rgb2="0.87 0.86 0.82"/>
    <material name="mat" texture="mat" texrepeat="4 4" texuniform="true" specular="0.1" shininess="0.1"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="30 30 1" material="mat"/>
  </worldbody>
</mujoco>
"""
"""What is around a row: the floor of `scene: {kind: flat}`, as in `templates/scene.xml.j2`, and a sky.

Their light and colours are those of pictures (`soft_light.py`, `body_camera.py`). Rooms and cribs are too small for a
row, and their toys would be in its way.
"""


@dataclass(frozen=True, slots=True)
class Move:
    """A turn about the vertical, and then a shift."""

    turn_rad: float
    shift_m: FloatArray  # Shape (3,).

    def points_m(self, scene_m: FloatArray) -> FloatArray:
        """Return points, shape (..., 3), where they are afterwards."""
        return scene_m @ matrix_from_axis(UP, self.turn_rad).T + self.shift_m

    def quaternion(self, scene_quat: FloatArray) -> FloatArray:
        """Return an orientation, shape (4,), as it is afterwards."""
        turn, turned = np.empty(4), np.empty(4)
        mujoco.mju_axisAngle2Quat(turn, UP, self.turn_rad)
        mujoco.mju_mulQuat(turned, turn, scene_quat)
        return turned


@dataclass(frozen=True, slots=True)
class Row:
    """Infants side by side along y on a floor, all facing +x, from the left."""

    data: mujoco.MjData  # The state of the model of all.
    roots: list[str]  # Names of their root bodies.
    moves: list[Move]  # What takes each infant, and what belongs to it, from its own scene to its place.


def row_of(bundles: Sequence[Bundle], pose: str | None) -> Row:
    """Return infants in a row, each in a pose; UnknownNameError if a bundle has no such pose."""
    states = [load_in_pose(bundle, pose)[1] for bundle in bundles]
    model, prefixes = _model_of(bundles)
    row, left_m = Row(mujoco.MjData(model), [], []), 0.0
    for bundle, alone, prefix in zip(bundles, states, prefixes, strict=True):
        root = bundle.manifest.root_body
        move, width_m = _to_place(alone, root, left_m)
        _take_pose(row.data, prefix, alone, move)
        row.moves.append(move)
        row.roots.append(prefix + root)
        left_m += width_m + GAP_M
    mujoco.mj_forward(model, row.data)
    return row


def _to_place(data: mujoco.MjData, root: str, left_m: float) -> tuple[Move, float]:
    """Return what takes an infant from where its scene has it to where its least y is *left_m*, and its width."""
    model = data.model
    front_deg, _ = view_of_body(FROM_THE_FRONT, data, root)
    turn = Move(float(np.radians(FROM_THE_FRONT[0] - front_deg)), np.zeros(3))
    geoms = in_subtrees(model, [model.body(root).id])[model.geom_bodyid]
    across = matrix_from_axis(UP, turn.turn_rad)[1] @ data.geom_xmat[geoms].reshape(-1, 3, 3)
    middles_m = model.geom_aabb[geoms, :3]
    halves_m = model.geom_aabb[geoms, 3:]
    y_m = turn.points_m(data.geom_xpos[geoms])[:, 1] + (across * middles_m).sum(axis=1)
    reach_m = (np.abs(across) * halves_m).sum(axis=1)
    low_m = float((y_m - reach_m).min())
    high_m = float((y_m + reach_m).max())
    x_m, _, _ = turn.points_m(data.body(root).xpos)
    return Move(turn.turn_rad, np.array([-x_m, left_m - low_m, 0.0])), high_m - low_m


def _take_pose(row: mujoco.MjData, prefix: str, alone: mujoco.MjData, move: Move) -> None:
    """Give an infant in a row the pose that it has alone; the toys of its scene are not there."""
    for number in range(alone.model.njnt):
        joint = alone.model.joint(number)
        if mujoco.mj_name2id(row.model, mujoco.mjtObj.mjOBJ_JOINT, prefix + joint.name) < 0:
            continue
        qpos = alone.joint(number).qpos.copy()
        if joint.type == mujoco.mjtJoint.mjJNT_FREE:
            qpos = np.concatenate([move.points_m(qpos[:3]), move.quaternion(qpos[3:])])
        row.joint(prefix + joint.name).qpos[:] = qpos


def _model_of(bundles: Sequence[Bundle]) -> tuple[mujoco.MjModel, list[str]]:
    prefixes = [f"{number}: " for number in range(len(bundles))]
    files: dict[str, bytes] = {}
    for bundle, prefix in zip(bundles, prefixes, strict=True):
        files |= {prefix + name: picture for name, picture in _files(bundle, ".png").items()}
        files |= {prefix + name: _renamed(skin, prefix) for name, skin in _files(bundle, ".skn").items()}
    row = mujoco.MjSpec.from_string(FLOOR, assets=files)
    for bundle, prefix in zip(bundles, prefixes, strict=True):
        infant = mujoco.MjSpec.from_string(bundle.files["infant.xml"].decode(), assets=_files(bundle, ".png"))
        scene = mujoco.MjSpec.from_string(bundle.files[bundle.manifest.scene].decode(), include=dict(bundle.files))
        for texture in infant.textures:
            texture.file = prefix + texture.file  # Infants of other looks have other pictures by the same names.
        for geom in infant.geoms:
            geom.group = scene.geom(geom.name).group  # Solids under a skin are in another one.
        infant.option, row.nuser_actuator = row.option, infant.nuser_actuator  # Where they differ, MuJoCo warns.
        row.attach(infant, frame=row.worldbody.add_frame(), prefix=prefix)
        for skin in scene.skins:
            name, file, material = (prefix + text for text in (skin.name, skin.file, skin.material))
            row.add_skin(name=name, file=file, material=material, group=skin.group)
    return row.compile(), prefixes


def _files(bundle: Bundle, ending: str) -> dict[str, bytes]:
    return {name: file for name, file in bundle.files.items() if name.endswith(ending)}


def _renamed(skin: bytes, prefix: str) -> bytes:
    """Return a file of a skin of bodies whose names begin with *prefix*; not every MuJoCo does this itself (3.5).

    The file has four counts, of vertices, texture coordinates, triangles and bodies, these vertices, coordinates and
    triangles, and then for each body its name, seven numbers of its pose, a count, and as many vertices and weights.
    """
    vertices, texcoords, triangles, bodies = np.frombuffer(skin, "<i4", 4).tolist()
    start = 4 * (4 + 3 * vertices + 2 * texcoords + 3 * triangles)
    parts = [skin[:start]]
    for _ in range(bodies):
        counted = start + NAME_BYTES + 4 * 7
        (moved,) = np.frombuffer(skin, "<i4", 1, counted).tolist()
        end = counted + 4 * (1 + 2 * moved)
        name = prefix.encode() + skin[start : start + NAME_BYTES].rstrip(b"\0")
        parts += [name.ljust(NAME_BYTES, b"\0"), skin[start + NAME_BYTES : end]]
        start = end
    return b"".join(parts)


ALL = "all"
MAX_PICTURES = 400  # How many pictures a sheet may have.


def read_poses(text: str, manifest: Manifest) -> list[str]:
    """Return the poses that a list such as `supine,crawling`, or `all`, names, or raise an UnknownNameError."""
    if text.strip() == ALL:
        return list(poses_in_pictures(manifest))
    names = [name.strip() for name in text.split(",")]
    if "" in names:
        check_name("pose", "", (*poses_in_pictures(manifest), ALL))
    return [pose_in_picture(manifest, name) for name in names]


def check_count(ages: int, poses: int) -> None:
    """Raise a MimocError if a sheet would have too many pictures."""
    if ages * poses > MAX_PICTURES:
        raise MimocError(f"{ages} ages in {poses} poses are {ages * poses} pictures; ask for at most {MAX_PICTURES}")


def age_label(age_months: float) -> str:
    """Return a caption for an age.

    >>> age_label(1), age_label(2.5)
    ('1 month', '2.5 months')
    """
    return f"{age_months:g} month" + ("" if age_months == 1 else "s")


def contact_sheet(
    infants: Iterable[Bundle],
    poses: Sequence[str],
    size_px: tuple[int, int],
    shown: Shown = "skin",
    framing: Framing | None = None,
    progress: Callable[[int], None] = lambda done: None,
) -> Picture:
    """Return a picture of infants in poses, shape (height, width, 3): a row for each age, a column for each pose.

    In one pose, all ages are in one row. Infants may be built as they are drawn; poses are start poses or for pictures.
    Raises an UnknownNameError for an unknown pose, a RenderingError without OpenGL.
    """
    rows: list[list[Picture]] = []
    labels: list[str] = []
    for infant in infants:
        row: list[Picture] = []
        for picture in portraits(infant, poses, *size_px, None, shown, framing or Framing()):
            row.append(picture)
            progress(len(rows) * len(poses) + len(row))
        rows.append(row)
        labels.append(age_label(infant.manifest.child.age_months))
    if len(poses) == 1:
        return tile_pictures([[picture for row in rows for picture in row]], columns=labels)
    return tile_pictures(rows, columns=poses, rows=labels)
