"""The shared scene: what is slow and what is sealed, made once for all clients and replayed to those who join late.

Everything of the field hangs under ``/w``, a frame that each client shadows with its own, so that its world can be
moved. Light and surroundings stand in the root and stay where they are. Nothing here is assigned at a tick's rate.
"""

import math

import viser

from guidance_app.console.growing import Ribbon, TrackLine
from guidance_app.console.machine import backdrop, flag
from guidance_app.documents import Job
from guidance_app.geodesy import FieldFrame
from guidance_app.model import FloatArray, Guidance, Snapshot
from guidance_app.view.camera import Extent
from guidance_app.view.colours import DAY, NIGHT, Palette, Rgb, flat_source, lit_source
from guidance_app.view.field import Mesh, everything, exclusion_mesh, ground_mesh, mainland_strokes, ring_strokes
from guidance_app.view.polyline import Segments
from guidance_app.view.scene import pass_lines

__all__ = ["WORLD", "Ground"]

WORLD = "/w"
AMBIENT_SHARE = 0.45
"""How much of the light comes from everywhere; the rest is the sun's, from behind on the left."""

SUN = (-450.0, 450.0, 770.0)
BACKDROP_RADIUS = 2600.0
Z_GRID = -0.06
START_FLAG: Rgb = (56, 190, 96)
LINE_FLAG: Rgb = (60, 130, 230)
ENTRANCE_FLAG: Rgb = (206, 160, 44)


class Ground:
    """The nodes all clients share. ``show`` looks what has changed and assigns only that."""

    def __init__(self, server: viser.ViserServer, job: Job, palette: Palette) -> None:
        self._scene = server.scene
        self._job = job
        self._palette = palette
        self._version: tuple[int, int] | None = None
        self._passes_key: object = ()
        self._line_start: tuple[float, float] | None = None
        self._seen: Snapshot | None = None
        self._generation = 0
        self._latest: Snapshot | None = None
        self.extent: Extent | None = None
        self._prepare()
        self.worked = Ribbon(self._scene, f"{WORLD}/worked", lit_source(palette.worked, palette.light))
        self.track = TrackLine(self._scene, f"{WORLD}/track", flat_source(palette.track))
        self.ghost = TrackLine(self._scene, f"{WORLD}/ghost", flat_source(palette.ghost))

    def _prepare(self) -> None:
        """Light, surroundings and the world's frame."""
        scene = self._scene
        scene.world_axes.visible = False
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map(hdri=None)
        self._ambient = scene.add_light_ambient("/light/ambient")
        self._sun = scene.add_light_directional("/light/sun", position=SUN)
        self._backdrops = {
            palette: scene.add_glb(f"/backdrop/{name}", backdrop(palette, BACKDROP_RADIUS), cast_shadow=False)
            for name, palette in (("day", DAY), ("night", NIGHT))
        }
        scene.add_frame(WORLD, show_axes=False)
        self._light()

    def _light(self) -> None:
        """A level surface gives back ``palette.light`` of its colour: light over pi, the sun's by its height."""
        whole = math.pi * self._palette.light
        self._ambient.intensity = AMBIENT_SHARE * whole
        self._sun.intensity = (1 - AMBIENT_SHARE) * whole / (SUN[2] / math.hypot(*SUN))
        for palette, node in self._backdrops.items():
            node.visible = palette is self._palette

    def set_palette(self, palette: Palette) -> None:
        """Another time of day."""
        if palette is self._palette:
            return
        self._palette = palette
        self._light()
        self.worked.recolour(lit_source(palette.worked, palette.light))
        self.track.recolour(flat_source(palette.track))
        self.ghost.recolour(flat_source(palette.ghost))
        self._version = self._seen = None
        if self._latest is not None:
            self.show(self._latest)

    def show(self, snapshot: Snapshot) -> None:
        """Brings the shared scene up to this snapshot."""
        self._latest = snapshot
        if snapshot.generation != self._generation:
            self._generation = snapshot.generation
            self.worked.clear()
            self.track.clear()
            self.ghost.clear()
        if self._version != (snapshot.ground_version, snapshot.generation):
            self._version = (snapshot.ground_version, snapshot.generation)
            self._passes_key = ()
            self._ground(snapshot)
        self._passes(snapshot)
        self._mark_line_start(snapshot)
        self.worked.feed(snapshot.worked)
        self.track.feed(snapshot.track)
        self.ghost.feed(None if snapshot.ghost is None else snapshot.ghost.track)
        self._measure(snapshot)

    def measure_anew(self) -> Extent | None:
        """The box of everything as it is now, without the room it was given to grow into."""
        if self._latest is not None:
            self.extent = everything(self._latest)
        return self.extent

    def _measure(self, snapshot: Snapshot) -> None:
        """Keeps the box of everything; it grows in large steps, so that the whole-field view moves rarely."""
        pose = snapshot.pose
        if self.extent is None:
            self.extent = everything(snapshot)
        elif pose is not None:
            box = self.extent.with_point(pose.east, pose.north)
            self.extent = self.extent if box == self.extent else box.grown(0.15)

    def _ground(self, snapshot: Snapshot) -> None:
        """Field and flags; a line that was moved changes the version too, and leaves them as they are."""
        seen = self._seen
        self._seen = snapshot
        if seen is None or seen.plan is not snapshot.plan or not _same(seen.field_rings, snapshot.field_rings):
            self._field(snapshot)
            self._flags(snapshot)

    def _field(self, snapshot: Snapshot) -> None:
        palette, rings = self._palette, snapshot.field_rings
        self.extent = None
        self._grid(shown=not rings)
        self._mesh("field/soil", ground_mesh(rings), palette.soil)
        self._mesh("field/exclusions", exclusion_mesh(rings), palette.exclusion)
        self._lines("field/boundary", ring_strokes(rings[:1]), palette.boundary, 4.0)
        self._lines("field/exclusion_edges", ring_strokes(rings[1:]), palette.exclusion_edge, 3.0)
        self._lines("field/mainland", mainland_strokes(snapshot), palette.mainland, 2.0)

    def _grid(self, *, shown: bool) -> None:
        """Without a field a grid of 10 m lies on the meadow, so that one sees that and where one moves."""
        path = f"{WORLD}/grid"
        if not shown:
            self._drop(path)
            return
        colour = flat_source(self._palette.grid)
        self._scene.add_grid(
            path,
            infinite_grid=True,
            cell_size=10.0,
            cell_color=colour,
            cell_thickness=1.2,
            section_size=50.0,
            section_color=colour,
            section_thickness=1.8,
            fade_distance=420.0,
            fade_strength=1.5,
            shadow_opacity=0.0,
            position=(0.0, 0.0, Z_GRID),
        )

    def _mesh(self, name: str, mesh: Mesh | None, colour: Rgb) -> None:
        path = f"{WORLD}/{name}"
        if mesh is None:
            self._drop(path)
            return
        self._scene.add_mesh_simple(
            path,
            mesh.vertices,
            mesh.faces,
            color=lit_source(colour, self._palette.light),
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _lines(self, name: str, strokes: Segments, colour: Rgb, thickness: float) -> None:
        path = f"{WORLD}/{name}"
        if len(strokes) == 0:
            self._drop(path)
            return
        self._scene.add_line_segments(path, strokes, flat_source(colour), thickness=thickness, thickness_units="screen")

    def _drop(self, path: str) -> None:
        handle = self._scene.get_handle_by_name(path)
        if handle is not None:
            handle.remove()

    def _passes(self, snapshot: Snapshot) -> None:
        """All passes in one node, sent again only when one of them has changed its state."""
        key = _pass_states(snapshot.guidance)
        if key == self._passes_key:
            return
        self._passes_key = key
        lines = pass_lines(snapshot.passes, snapshot.guidance, self._palette)
        path = f"{WORLD}/passes"
        if len(lines.points) == 0:
            self._drop(path)
            return
        self._scene.add_line_segments(path, lines.points, lines.colours, thickness=2.0, thickness_units="screen")

    def _flags(self, snapshot: Snapshot) -> None:
        """A green flag where the plan begins, a yellow one at the field's entrance."""
        start = entrance = None
        if snapshot.plan is not None and snapshot.plan.segments:
            east, north = snapshot.plan.segments[0].points[0]
            start = float(east), float(north)
        field = self._job.field
        if field is not None and field.entrance is not None and snapshot.origin_deg is not None:
            entrance = FieldFrame(*snapshot.origin_deg).east_north_from_degrees(field.entrance[1], field.entrance[0])
        for name, place, colour in (("start", start, START_FLAG), ("entrance", entrance, ENTRANCE_FLAG)):
            self._flag(name, place, colour)

    def _mark_line_start(self, snapshot: Snapshot) -> None:
        """A blue flag at A while a line is drawn."""
        start = None if snapshot.line_begun is None else snapshot.line_begun.start
        if start != self._line_start:
            self._line_start = start
            self._flag("line", start, LINE_FLAG)

    def _flag(self, name: str, place: tuple[float, float] | None, colour: Rgb) -> None:
        path = f"{WORLD}/flags/{name}"
        if place is None:
            self._drop(path)
        else:
            self._scene.add_glb(path, flag(colour), position=(*place, 0.0), cast_shadow=False)


def _same(one: tuple[FloatArray, ...], other: tuple[FloatArray, ...]) -> bool:
    """True when both hold the very same arrays."""
    return len(one) == len(other) and all(a is b for a, b in zip(one, other, strict=True))


def _pass_states(guidance: Guidance | None) -> object:
    """What decides how the passes are drawn."""
    return None if guidance is None else (guidance.target.number, guidance.next_number, guidance.done)
