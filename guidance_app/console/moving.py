"""What moves, for one client: its world, tractor and implement, what lies ahead, the target, numbers, newest work.

All of it is in the client's own scope, so that it ends with the connection. Between two fixes a redraw moves
the world's frame, the tractor's frame and the ellipse; everything that hangs on the tractor is described from it and
sent once for each fix. Handles are made once and then assigned; viser drops what has not changed.
"""

import math
from dataclasses import dataclass

import numpy as np
import viser

from guidance_app.angles import yaw_from_heading
from guidance_app.console.ground import WORLD, Ground
from guidance_app.console.growing import add_track, add_worked
from guidance_app.console.machine import implement_model, tractor_model
from guidance_app.documents import Job
from guidance_app.model import Pass, Snapshot, TurnGuide
from guidance_app.view.camera import (
    FIELD_OF_VIEW,
    CameraHome,
    Extent,
    ViewMode,
    WorldPose,
    camera_home,
    eased_heading,
    world_pose,
)
from guidance_app.view.colours import Palette, Rgb, flat_source, lit_source
from guidance_app.view.outlines import (
    arc_strokes,
    ghost_strokes,
    hollow_strokes,
    implement_place,
    ring_strokes,
    working_edge,
)
from guidance_app.view.polyline import Segments, segments
from guidance_app.view.scene import Shown, ellipse, number_layout, numbers, pass_strokes, shown_pose, turn_colour

__all__ = ["ClientScene", "Models"]

Z_TURN, Z_ELLIPSE = 0.125, 0.13
LIFTED = 0.35
"""How high a lifted implement hangs."""

RESHAPED = math.log(1.15)
"""A picture that is so much wider or narrower for its height has another home for the camera."""

NOWHERE = Extent(-50.0, -50.0, 50.0, 50.0)
NOTHING = np.zeros((1, 2, 3), dtype=np.float32)
HERE = f"{WORLD}/here"


@dataclass(frozen=True, slots=True)
class Models:
    """The GLB models of a job, made once for all clients."""

    tractor: bytes
    implement: bytes

    @classmethod
    def of(cls, job: Job) -> "Models":
        """The models in the documents' true sizes."""
        return cls(tractor_model(job.tractor), implement_model(job.implement))


class ClientScene:
    """One client's moving scene and camera. ``draw`` is called by the redraw loop alone."""

    def __init__(self, client: viser.ClientHandle, job: Job, models: Models, palette: Palette) -> None:
        self._client = client
        self._job = job
        self._palette = palette
        self._mode = ViewMode.DRIVER
        self._home: CameraHome | None = None
        self._home_key: object = None
        self._home_aspect = 1.0
        self._shown_heading: float | None = None
        self._last_now: float | None = None
        self._lies = WorldPose(0.0, 0.0, 0.0)
        self._drawn: dict[str, object] = {}
        scene = client.scene
        self._world = scene.add_frame(WORLD, show_axes=False)
        self._here = scene.add_frame(HERE, show_axes=False, visible=False)
        self._tractor = scene.add_glb(f"{HERE}/tractor", models.tractor, cast_shadow=False)
        self._implement = scene.add_glb(f"{HERE}/implement", models.implement, cast_shadow=False)
        self._lines = {
            name: scene.add_line_segments(
                path, NOTHING, flat_source(self._colour(name)), thickness=width, thickness_units="screen", visible=False
            )
            for name, path, width in _LINES
        }
        self._number_node: viser.LineSegmentsHandle | None = None
        self._open_worked: viser.MeshHandle | None = None
        self._open_track: viser.LineSegmentsHandle | None = None
        self._open_ghost: viser.LineSegmentsHandle | None = None
        client.camera.fov = FIELD_OF_VIEW

    @property
    def world(self) -> WorldPose:
        """How this client's map lies under its camera now."""
        return self._lies

    @property
    def mode(self) -> ViewMode:
        """The view this client has chosen."""
        return self._mode

    def look(self, mode: ViewMode) -> None:
        """Another view, from its home."""
        self._mode = mode
        self.bring_back()

    def bring_back(self) -> None:
        """The camera goes home at the next redraw."""
        self._home_key = None
        self._shown_heading = None

    def set_palette(self, palette: Palette) -> None:
        """Another time of day."""
        self._palette = palette
        self._drawn.clear()
        for name, handle in self._lines.items():
            handle.colors = np.array(flat_source(self._colour(name)), dtype=np.uint8)
        if self._open_worked is not None:
            self._open_worked.color = lit_source(palette.worked, palette.light)
        if self._open_track is not None:
            self._open_track.colors = np.array(flat_source(palette.track), dtype=np.uint8)
        if self._open_ghost is not None:
            self._open_ghost.colors = np.array(flat_source(palette.ghost), dtype=np.uint8)

    def _colour(self, name: str) -> Rgb:
        palette = self._palette
        return {
            "edge": palette.lifted_edge,
            "off": palette.stale,
            "arc": palette.predicted,
            "ghost": palette.predicted,
            "hollow": palette.stale,
            "ellipse": palette.uncertain,
            "target": palette.pass_target,
            "turn": palette.turn,
        }[name]

    def draw(self, snapshot: Snapshot, now: float, ground: Ground) -> None:
        """One redraw, as one batch of messages."""
        shown = shown_pose(snapshot, now)
        with self._client.atomic():
            self._camera(ground)
            self._move_world(shown, now, ground.extent)
            self._machine(snapshot, shown)
            self._ahead(snapshot, shown)
            self._uncertain(snapshot, shown)
            self._target(snapshot)
            self._turn(snapshot)
            self._numbers(snapshot, shown)
            self._newest(ground)
        self._client.flush()

    # --- camera and world ------------------------------------------------------------------------------------------

    def _camera(self, ground: Ground) -> None:
        """Sends the camera home when the view, the picture's shape or the field have changed; never else.

        On a phone the picture is what the panels leave of the screen: a line more there does not move the camera.
        """
        camera = self._client.camera
        aspect = camera.image_width / max(camera.image_height, 1)
        asked = self._home_key is None and self._mode is ViewMode.WHOLE_FIELD
        box = (ground.measure_anew() if asked else ground.extent) or NOWHERE
        key = (self._mode, box if self._mode is ViewMode.WHOLE_FIELD else None)
        reshaped = abs(math.log(aspect / self._home_aspect)) > RESHAPED
        if key == self._home_key and not reshaped:
            return
        self._home_key, self._home_aspect = key, aspect
        width = self._job.implement.working_width
        self._lines["target"].thickness = 4.0 if self._mode is ViewMode.WHOLE_FIELD else 6.0
        home = camera_home(self._mode, width=width, extent=box, aspect=aspect)
        self._home = home
        camera.fov = FIELD_OF_VIEW
        camera.near, camera.far = home.near, home.far
        camera.min_orbit_distance = 2 * home.near
        camera.max_orbit_distance = home.far / 2
        camera.up_direction = (0.0, 0.0, 1.0)
        camera.position = home.position
        camera.look_at = home.look_at

    def _move_world(self, shown: Shown | None, now: float, extent: Extent | None) -> None:
        middle = (0.0, 0.0) if extent is None else extent.middle
        heading = 0.0
        if shown is not None:
            seconds = 0.0 if self._last_now is None else now - self._last_now
            heading = eased_heading(self._shown_heading, shown.heading, seconds)
            self._shown_heading = heading
            middle = (shown.east, shown.north) if self._mode.follows else middle
        self._last_now = now
        world = self._lies = world_pose(self._mode, middle, heading)
        self._world.wxyz = _wxyz(world.yaw)
        self._world.position = (world.x, world.y, 0.0)

    # --- tractor and what hangs on it ------------------------------------------------------------------------------

    def _machine(self, snapshot: Snapshot, shown: Shown | None) -> None:
        self._here.visible = shown is not None
        if shown is None:
            return
        self._here.position = (shown.east, shown.north, 0.0)
        self._here.wxyz = _wxyz(yaw_from_heading(shown.heading))
        solid = shown.heading_known and not shown.stale
        self._tractor.visible = solid
        self._implement.visible = solid
        place = implement_place(snapshot, self._job.implement)
        self._implement.position = (place.x, place.y, 0.0 if snapshot.working else LIFTED)
        self._implement.wxyz = _wxyz(place.yaw)
        if self._changed("hollow", (shown.heading_known, solid, place)):
            outline = (
                hollow_strokes(self._job.tractor, self._job.implement, place) if shown.heading_known else ring_strokes()
            )
            self._assign("hollow", None if solid else outline)
        if self._changed("edge", (solid, place, snapshot.working, snapshot.sections)):
            edge = working_edge(self._job.implement, place)
            on = np.resize(np.array(snapshot.sections, dtype=bool), len(edge))
            self._assign("edge", edge[on] if solid else None)
            self._assign("off", edge[~on] if solid else None)
            colour = self._palette.working_edge if snapshot.working else self._palette.lifted_edge
            self._lines["edge"].colors = np.array(flat_source(colour), dtype=np.uint8)

    def _ahead(self, snapshot: Snapshot, shown: Shown | None) -> None:
        """The arc and the ghost, once for each prediction; nothing while the position is stale."""
        ahead = snapshot.prediction if shown is not None and not shown.stale else None
        if not self._changed("ahead", ahead):
            return
        self._assign("arc", arc_strokes(snapshot) if ahead else None)
        self._assign("ghost", ghost_strokes(snapshot, self._job.tractor, self._job.implement) if ahead else None)

    def _uncertain(self, snapshot: Snapshot, shown: Shown | None) -> None:
        covariance = snapshot.pose.covariance if snapshot.pose is not None else None
        size = None if covariance is None else tuple(float(f"{value:.2g}") for value in covariance)
        if self._changed("ellipse", size):
            outline = ellipse(covariance)
            self._assign("ellipse", None if outline is None else segments(outline, Z_ELLIPSE))
        if shown is not None and self._lines["ellipse"].visible:
            self._lines["ellipse"].position = (shown.east, shown.north, 0.0)

    # --- what lies on the ground -----------------------------------------------------------------------------------

    def _target(self, snapshot: Snapshot) -> None:
        target: Pass | None = None if snapshot.guidance is None else snapshot.guidance.target
        if self._changed("target", None if target is None else (target.number, _fingerprint(target.points))):
            self._assign("target", None if target is None else pass_strokes(target))

    def _turn(self, snapshot: Snapshot) -> None:
        turn: TurnGuide | None = None if snapshot.guidance is None else snapshot.guidance.turn
        colour = None if turn is None else turn_colour(turn, self._palette)
        if turn is None or colour is None:
            if self._changed("turn", None):
                self._assign("turn", None)
            return
        if self._changed("turn", _fingerprint(turn.points)):
            self._assign("turn", segments(turn.points, Z_TURN))
        self._lines["turn"].colors = np.array(flat_source(colour), dtype=np.uint8)

    def _numbers(self, snapshot: Snapshot, shown: Shown | None) -> None:
        """Numbers are laid out anew when the tractor has come a step farther, not at every redraw."""
        if self._home is None:
            return
        layout = number_layout(
            self._mode, math.dist(self._home.position, self._home.look_at), self._job.implement.spacing
        )
        place = None
        if shown is not None and self._mode.follows:
            step = layout.every / 8
            place = (round(shown.east / step), round(shown.north / step), round(shown.heading / 0.1))
        guidance = snapshot.guidance
        states = None if guidance is None else (guidance.target.number, guidance.done)
        if not self._changed("numbers", (self._mode, layout, place, states, snapshot.ground_version)):
            return
        lines = numbers(snapshot, shown, self._mode, layout, self._palette)
        if self._changed("number strokes", (_fingerprint(lines.points), states, self._palette.number)):
            if len(lines.points) == 0:
                if self._number_node is not None:
                    self._number_node.visible = False
                return
            self._number_node = self._client.scene.add_line_segments(
                f"{WORLD}/numbers", lines.points, lines.colours, thickness=3.0, thickness_units="screen"
            )

    def _newest(self, ground: Ground) -> None:
        """The open arrays of worked ground and track; their nodes stand above the shared ones of the same series."""
        palette = self._palette
        if self._changed("worked series", ground.worked.series) or self._open_worked is None:
            self._open_worked = add_worked(
                self._client.scene,
                f"{WORLD}/worked_open",
                ground.worked.open_array(),
                lit_source(palette.worked, palette.light),
            )
        elif self._changed("worked", ground.worked.version):
            self._open_worked.vertices = ground.worked.open_array()
        if self._open_track is None:
            colour = flat_source(palette.track)
            self._open_track = add_track(self._client.scene, f"{WORLD}/track_open", ground.track.open_array(), colour)
        elif self._changed("track", ground.track.version):
            self._open_track.points = ground.track.open_array()
        self._newest_ghost(ground)

    def _newest_ghost(self, ground: Ground) -> None:
        """The open array of the ghost's track, in a replay that has one."""
        if not self._changed("ghost", ground.ghost.version):
            return
        if self._open_ghost is not None:
            self._open_ghost.points = ground.ghost.open_array()
        elif ground.ghost.version:
            colour = flat_source(self._palette.ghost)
            self._open_ghost = add_track(self._client.scene, f"{WORLD}/ghost_open", ground.ghost.open_array(), colour)

    def _changed(self, name: str, key: object) -> bool:
        """True once for each new ``key`` of this part of the scene."""
        if name in self._drawn and self._drawn[name] == key:
            return False
        self._drawn[name] = key
        return True

    def _assign(self, name: str, strokes: Segments | None) -> None:
        handle = self._lines[name]
        if strokes is not None and len(strokes):
            handle.points = strokes
            handle.visible = True
        else:
            handle.visible = False


_LINES = (
    ("edge", f"{HERE}/edge", 6.0),
    ("off", f"{HERE}/off", 2.0),
    ("arc", f"{HERE}/arc", 4.0),
    ("ghost", f"{HERE}/ghost", 2.5),
    ("hollow", f"{HERE}/hollow", 3.0),
    ("ellipse", f"{WORLD}/uncertain", 2.0),
    ("target", f"{WORLD}/target", 6.0),
    ("turn", f"{WORLD}/turn", 5.0),
)
"""Name, node and width in pixels of every line that moves."""


def _fingerprint(points: np.ndarray) -> tuple[int, int]:
    """Changes when the array does."""
    return len(points), hash(points.tobytes())


def _wxyz(yaw: float) -> tuple[float, float, float, float]:
    """The quaternion of a turn around z."""
    return math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)
