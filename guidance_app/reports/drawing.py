"""The map of a drive as a picture: boundary, what was worked in its true width, and the way of the tractor."""

import io

import numpy as np
from PIL import Image, ImageDraw

from guidance_app.model import FloatArray
from guidance_app.reports.ledger import LedgerEntry

__all__ = ["extent_of", "map_png", "placed"]

SOIL, WORKED, TRACK, EDGE, PAPER = (222, 205, 178), (120, 170, 90), (60, 90, 60), (150, 100, 20), (255, 255, 255)
MARGIN = 0.05
Extent = tuple[float, float, float]


def extent_of(entry: LedgerEntry) -> Extent:
    """West edge, north edge and width in metres of the square around everything."""
    points = [ring for ring in (*entry.boundary, entry.track, *entry.worked_track) if len(ring)]
    if not points:
        return -50.0, 50.0, 100.0
    every = np.vstack(points)
    low, high = every.min(axis=0), every.max(axis=0)
    size = max(float((high - low).max()), 10.0) * (1 + 2 * MARGIN)
    middle = (low + high) / 2
    return float(middle[0] - size / 2), float(middle[1] + size / 2), size


def placed(points: FloatArray, extent: Extent, pixels: float) -> FloatArray:
    """East and north as right and down in a square picture; shape (N, 2)."""
    west, north, size = extent
    return np.column_stack([(points[:, 0] - west), (north - points[:, 1])]) * (pixels / size)


def map_png(entry: LedgerEntry, pixels: int = 600) -> bytes:
    """The map as a square PNG, drawn at twice its size for smooth edges."""
    large = 2 * pixels
    extent = extent_of(entry)
    picture = Image.new("RGB", (large, large), PAPER)
    pen = ImageDraw.Draw(picture)
    for number, ring in enumerate(entry.boundary):
        pen.polygon(_flat(placed(ring, extent, large)), fill=SOIL if number == 0 else PAPER)
    width = max(round(entry.width * large / extent[2]), 1)
    for piece in entry.worked_track:
        pen.line(_flat(placed(piece, extent, large)), fill=WORKED, width=width)
    pen.line(_flat(placed(entry.track, extent, large)), fill=TRACK, width=2)
    for ring in entry.boundary:
        outline = placed(np.vstack([ring, ring[:1]]), extent, large)
        pen.line(_flat(outline), fill=EDGE, width=5)
    made = io.BytesIO()
    picture.resize((pixels, pixels), Image.Resampling.LANCZOS).save(made, "PNG", optimize=True)
    return made.getvalue()


def _flat(points: FloatArray) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in points]
