"""Tractor, implement, flag and surroundings as GLB models, made from the documents by trimesh.

x points ahead, y to the left, z up. Colours stand on the vertices, as linear light; nothing is metallic, because there
is no environment to mirror. The models of the surroundings are not lit at all.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb

from guidance_app.documents import HitchKind, Implement, Tractor
from guidance_app.model import FloatArray
from guidance_app.view.colours import Palette, Rgb, vertex_source
from guidance_app.view.outlines import REAR_TYRE, tractor_scale

__all__ = ["backdrop", "flag", "implement_model", "tractor_model"]

_PAINT: Rgb = (196, 60, 42)
_PAINT_DARK: Rgb = (150, 44, 32)
_GLASS: Rgb = (38, 52, 62)
_ROOF: Rgb = (206, 206, 202)
_RUBBER: Rgb = (34, 35, 37)
_RIM: Rgb = (214, 200, 150)
_STEEL: Rgb = (92, 98, 104)
_IMPLEMENT: Rgb = (222, 158, 40)
_LAMP: Rgb = (226, 120, 40)


def _painted(mesh: trimesh.Trimesh, colour: Rgb) -> trimesh.Trimesh:
    """The mesh with one colour and hard edges."""
    mesh.unmerge_vertices()
    return _coloured(mesh, np.tile(np.array(vertex_source(colour)), (len(mesh.vertices), 1)))


def _coloured(mesh: trimesh.Trimesh, colours: FloatArray) -> trimesh.Trimesh:
    rgba = np.column_stack([colours, np.full(len(colours), 255)]).astype(np.uint8)
    mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=rgba)
    return mesh


def _box(size: tuple[float, float, float], at: tuple[float, float, float], colour: Rgb) -> trimesh.Trimesh:
    mesh = trimesh.creation.box(size)
    mesh.apply_translation(at)
    return _painted(mesh, colour)


def _prism(side: Iterable[tuple[float, float]], half: tuple[float, float], colour: Rgb) -> trimesh.Trimesh:
    """A convex outline in x and z, counter-clockwise seen from the right; half as wide as ``half`` below and above."""
    outline = np.array(list(side))
    low, high = outline[:, 1].min(), outline[:, 1].max()
    share = (outline[:, 1] - low) / (high - low)
    width = half[0] + share * (half[1] - half[0])
    right = np.column_stack([outline[:, 0], -width, outline[:, 1]])
    left = np.column_stack([outline[:, 0], width, outline[:, 1]])
    count = len(outline)
    fan = [(0, k, k + 1) for k in range(1, count - 1)]
    faces = fan + [(count + a, count + c, count + b) for a, b, c in fan]
    for k in range(count):
        after = (k + 1) % count
        faces += [(k, k + count, after), (after, k + count, after + count)]
    return _painted(trimesh.Trimesh(np.vstack([right, left]), faces, process=False), colour)


def _wheel(radius: float, width: float, at: tuple[float, float, float]) -> list[trimesh.Trimesh]:
    """A tyre with a rim that stands out a little on both sides."""
    parts = [
        (radius, width, 20, _RUBBER),
        (0.56 * radius, 1.06 * width, 12, _RIM),
        (0.2 * radius, 1.2 * width, 8, _STEEL),
    ]
    wheels = []
    for size, broad, sections, colour in parts:
        mesh = trimesh.creation.cylinder(size, broad, sections=sections)
        mesh.vertices = mesh.vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
        mesh.apply_translation(at)
        wheels.append(_painted(mesh, colour))
    return wheels


def tractor_model(tractor: Tractor) -> bytes:
    """The tractor in its true wheelbase and track, origin at the rear axle's centre on the ground; GLB."""
    k = tractor_scale(tractor)
    base, track = tractor.wheelbase, tractor.track_width
    rear, front = REAR_TYRE * k, 0.52 * k
    nose = base + 0.62 * k
    parts = [
        _prism(
            [
                (0.55 * k, 0.75 * k),
                (nose, 0.75 * k),
                (nose + 0.06 * k, 1.2 * k),
                (nose - 0.12 * k, 1.5 * k),
                (0.55 * k, 1.72 * k),
            ],
            (0.4 * k, 0.34 * k),
            _PAINT,
        ),
        _box((0.06 * k, 0.5 * k, 0.36 * k), (nose + 0.04 * k, 0, 1.08 * k), _RUBBER),
        _box((0.42 * k, 0.6 * k, 0.34 * k), (nose + 0.2 * k, 0, 0.72 * k), _STEEL),
        _box((base + 0.5 * k, 0.36 * k, 0.3 * k), (base / 2, 0, 0.72 * k), _STEEL),
        _box((0.9 * k, 0.16 * k, 0.16 * k), (base, 0, front), _STEEL),
        _box((0.2 * k, track, 0.2 * k), (base, 0, front), _STEEL),
        _box((0.24 * k, track, 0.24 * k), (0, 0, rear), _STEEL),
        _prism(
            [
                (-0.62 * k, 1.0 * k),
                (0.72 * k, 1.0 * k),
                (0.86 * k, 1.7 * k),
                (0.62 * k, 2.55 * k),
                (-0.6 * k, 2.55 * k),
            ],
            (0.66 * k, 0.58 * k),
            _GLASS,
        ),
        _box((1.6 * k, 1.36 * k, 0.12 * k), (0.02 * k, 0, 2.61 * k), _ROOF),
        _box((1.5 * k, 1.2 * k, 0.3 * k), (0.02 * k, 0, 1.02 * k), _PAINT_DARK),
        _box((0.09 * k, 0.09 * k, 0.95 * k), (0.98 * k, -0.4 * k, 2.0 * k), _STEEL),
    ]
    for side in (-1, 1):
        inside = side * (track / 2)
        parts += _wheel(rear, 0.46 * k, (0, inside, rear))
        parts += _wheel(front, 0.34 * k, (base, inside * 0.96, front))
        parts += [
            _box((1.5 * k, 0.5 * k, 0.08 * k), (-0.02 * k, inside, 2 * rear + 0.06 * k), _PAINT),
            _box((0.08 * k, 0.16 * k, 0.14 * k), (-0.76 * k, inside, 2 * rear), _LAMP),
            *(
                _box((0.07 * k, 0.07 * k, 1.5 * k), (x * k, side * 0.6 * k, 1.85 * k), _PAINT_DARK)
                for x in (-0.6, 0.66)
            ),
        ]
    return _glb(parts)


def implement_model(implement: Implement) -> bytes:
    """The implement in its true width around its working point on the ground, with its way to the hitch; GLB."""
    width, depth = implement.working_width, max(implement.length, 0.3)
    parts = [
        _box((0.16, width, 0.16), (x, 0.0, 0.62), _IMPLEMENT)
        for x in ((-depth / 2 + 0.1, depth / 2 - 0.1) if depth > 0.7 else (0.0,))
    ]
    count = int(min(max(round(width / 0.75), 2), 48))
    for y in np.linspace(-width / 2 + 0.1, width / 2 - 0.1, count):
        parts.append(_box((depth, 0.08, 0.1), (0.0, float(y), 0.56), _IMPLEMENT))
        parts.append(_box((0.1, 0.06, 0.5), (-depth / 2 + 0.1, float(y), 0.28), _STEEL))
    parts += [_box((depth + 0.2, 0.06, 0.3), (0.0, side * (width / 2), 0.58), _PAINT_DARK) for side in (-1, 1)]
    parts += _linkage(implement, depth)
    return _glb(parts)


def _linkage(implement: Implement, depth: float) -> list[trimesh.Trimesh]:
    """The bars from the implement's frame forward to the tractor; a front implement's reach back."""
    if implement.hitch is HitchKind.TRAILED:
        reach = implement.offset_back - implement.hitch_back
        wheels = [part for side in (-1, 1) for part in _wheel(0.45, 0.3, (reach - implement.drawbar, side * 0.9, 0.45))]
    else:
        reach, wheels = implement.offset_back - 0.55, []
    bars = []
    inner = math.copysign(depth / 2, reach)
    if abs(reach) > depth / 2:
        for y in (-0.35, 0.35):
            right = implement.offset_right
            bars.append(_box((abs(reach - inner), 0.08, 0.08), ((reach + inner) / 2, y + right, 0.6), _STEEL))
    return bars + wheels


def flag(colour: Rgb) -> bytes:
    """A flag on a pole 4 m high, for a start or an entrance; GLB."""
    cloth = _prism([(0.0, 2.9), (1.3, 3.35), (0.0, 3.9)], (0.03, 0.03), colour)
    return _glb([_box((0.09, 0.09, 4.0), (0.0, 0.0, 2.0), _ROOF), cloth])


def backdrop(palette: Palette, radius: float) -> bytes:
    """The meadow to the horizon and the sky over it, as seen from inside, not lit; GLB."""
    rings = [(share * radius, 0.0, _between(palette.meadow, palette.horizon, haze)) for share, haze in _HAZE]
    dome = [
        (radius * math.cos(angle), radius * math.sin(angle), _between(palette.horizon, palette.sky, share))
        for angle, share in ((0.0, 0.0), (0.06, 0.12), (0.16, 0.4), (0.35, 0.72), (0.7, 0.95), (1.5, 1.0))
    ]
    return _glb([_turned(rings, -0.12), _turned(dome, -0.12)], lit=False)


_HAZE = ((0.0, 0.0), (0.03, 0.0), (0.08, 0.06), (0.16, 0.18), (0.3, 0.4), (0.55, 0.7), (1.0, 1.0))


def _between(one: Rgb, other: Rgb, share: float) -> Rgb:
    mixed = [round(a + (b - a) * share) for a, b in zip(one, other, strict=True)]
    return mixed[0], mixed[1], mixed[2]


def _turned(rings: list[tuple[float, float, Rgb]], z: float, around: int = 48) -> trimesh.Trimesh:
    """A surface of rings (radius, height, colour) around z: flat ones face up, a dome faces in."""
    angle = np.linspace(0.0, math.tau, around, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    vertices = np.vstack([np.column_stack([circle * r, np.full(around, height + z)]) for r, height, _ in rings])
    colours = np.repeat(np.array([vertex_source(colour) for _, _, colour in rings]), around, axis=0)
    faces = []
    for ring in range(len(rings) - 1):
        for k in range(around):
            a, b = ring * around + k, ring * around + (k + 1) % around
            c, d = a + around, b + around
            faces += [(a, c, b), (b, c, d)] if rings[-1][1] == 0.0 else [(a, b, c), (b, d, c)]
    return _coloured(trimesh.Trimesh(vertices, faces, process=False), colours)


def _glb(parts: list[trimesh.Trimesh], *, lit: bool = True) -> bytes:
    whole = trimesh.util.concatenate(parts)
    change = _matt if lit else _unlit
    return bytes(export_glb(trimesh.Scene([whole]), tree_postprocessor=change))  # type: ignore[no-untyped-call]  # trimesh


def _material(extra: dict[str, Any]) -> Callable[[dict[str, Any]], None]:
    def change(tree: dict[str, Any]) -> None:
        surface = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
        tree["materials"] = [{"pbrMetallicRoughness": surface, "doubleSided": True, **extra}]
        for mesh in tree["meshes"]:
            for primitive in mesh["primitives"]:
                primitive["material"] = 0
        if "extensions" in extra:
            tree["extensionsUsed"] = list(extra["extensions"])

    return change


_matt = _material({})
_unlit = _material({"extensions": {"KHR_materials_unlit": {}}})
