"""Photos and scanned maps as the console lays them on the ground: read, made small, drawn as one textured sheet.

PNG, JPEG and TIFF are read with Pillow; the tags of a GeoTIFF give four matched points at once.
"""

import io
import warnings
from dataclasses import dataclass

import numpy as np
import trimesh
from PIL import Image
from pyproj import CRS
from pyproj.exceptions import CRSError
from trimesh.exchange.gltf import export_glb
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

from guidance_app.documents import MatchedPoint
from guidance_app.geodesy import lonlat_from
from guidance_app.model import FloatArray

__all__ = ["Photo", "PhotoError", "opened_photo", "sheet"]

MOST_PIXELS = 200_000_000
SIDE = 2048
"""Pixels of the longer side as it is shown; a tablet's graphics take no more gladly."""
Z_PHOTO = 0.035
SCALE_TAG, TIEPOINT_TAG, KEYS_TAG = 33550, 33922, 34735
GEOGRAPHIC_KEY, PROJECTED_KEY = 2048, 3072


class PhotoError(ValueError):
    """A picture that cannot be taken; the message is one sentence."""


@dataclass(frozen=True, slots=True)
class Photo:
    """A picture as JPEG with its size in pixels, and the points that it brought along."""

    name: str
    picture: bytes
    width: int
    height: int
    points: tuple[MatchedPoint, ...] = ()


def opened_photo(name: str, content: bytes) -> Photo:
    """The photo in a file's bytes, made small enough to show. Raises ``PhotoError``."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            picture = Image.open(io.BytesIO(content), formats=("PNG", "JPEG", "TIFF"))
        if picture.width * picture.height > MOST_PIXELS:
            msg = f"{name} has {picture.width} x {picture.height} pixels; {MOST_PIXELS // 10**6} million are the most"
            raise PhotoError(msg)
        points = _points_of_tiff(picture)
        factor = min(1.0, SIDE / max(picture.size))
        small = picture.convert("RGB")
    except (OSError, SyntaxError, Image.DecompressionBombError) as error:
        msg = f"{name} is no picture that can be read: PNG, JPEG and TIFF are taken"
        raise PhotoError(msg) from error
    if factor < 1.0:
        small = small.resize((max(round(picture.width * factor), 1), max(round(picture.height * factor), 1)))
    made = io.BytesIO()
    small.save(made, "JPEG", quality=88)
    scaled = tuple(one.model_copy(update={"right": one.right * factor, "down": one.down * factor}) for one in points)
    return Photo(name.rsplit(".", 1)[0][:100] or "Map", made.getvalue(), small.width, small.height, scaled)


def _points_of_tiff(picture: Image.Image) -> tuple[MatchedPoint, ...]:
    """The four corners of a GeoTIFF that lies north up; nothing for any other picture."""
    tags = getattr(picture, "tag_v2", None)
    if tags is None or SCALE_TAG not in tags or TIEPOINT_TAG not in tags or KEYS_TAG not in tags:
        return ()
    scale, tie, keys = tags[SCALE_TAG], tags[TIEPOINT_TAG], tags[KEYS_TAG]
    codes = {keys[at]: keys[at + 3] for at in range(4, len(keys) - 3, 4)}
    code = codes.get(PROJECTED_KEY) or codes.get(GEOGRAPHIC_KEY)
    if code is None:
        return ()
    try:
        system = CRS.from_epsg(code)
    except CRSError:
        return ()
    corners = [(0.0, 0.0), (picture.width, 0.0), (picture.width, picture.height), (0.0, picture.height)]
    plane = np.array(
        [(tie[3] + (right - tie[0]) * scale[0], tie[4] - (down - tie[1]) * scale[1]) for right, down in corners]
    )
    lonlat = lonlat_from(system)(plane)
    return tuple(
        MatchedPoint(right=right, down=down, longitude_deg=float(lon), latitude_deg=float(lat))
        for (right, down), (lon, lat) in zip(corners, lonlat, strict=True)
    )


def sheet(photo: Photo, corners: FloatArray) -> bytes:
    """The photo as GLB; ``corners`` are east and north of its upper left, upper right, lower right, lower left."""
    vertices = np.column_stack([np.asarray(corners, dtype=float), np.full(4, Z_PHOTO)])
    faces = np.array([[0, 2, 1], [0, 3, 2]])
    places = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])
    picture = Image.open(io.BytesIO(photo.picture))
    material = PBRMaterial(  # type: ignore[no-untyped-call]  # trimesh
        baseColorTexture=picture, metallicFactor=0.0, roughnessFactor=1.0, doubleSided=True
    )
    visual = TextureVisuals(uv=places, material=material)  # type: ignore[no-untyped-call]  # trimesh
    mesh = trimesh.Trimesh(vertices, faces, visual=visual, process=False)
    made: bytes = export_glb(trimesh.Scene([mesh]))  # type: ignore[no-untyped-call]  # trimesh
    return made
