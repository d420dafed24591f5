"""Photos laid by matched points: known maps come back, residuals tell the wrong point, nonsense is refused."""

import io
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image, TiffImagePlugin

from guidance_app.console.photo import PhotoError, opened_photo, sheet
from guidance_app.documents import MatchedPoint
from guidance_app.geodesy import FieldFrame
from guidance_app.map_fitting import FitError, fitted

CENTIMETRE = 1e-2
FRAME = FieldFrame(47.5, 8.5)
PIXELS = np.array([[100.0, 100.0], [900.0, 120.0], [880.0, 700.0], [80.0, 680.0], [500.0, 400.0]])


def matched(ground: np.ndarray, pixels: np.ndarray = PIXELS) -> list[MatchedPoint]:
    lonlat = FRAME.lonlat_from_array(ground)
    return [
        MatchedPoint(right=float(right), down=float(down), longitude_deg=float(lon), latitude_deg=float(lat))
        for (right, down), (lon, lat) in zip(pixels, lonlat, strict=True)
    ]


def laid(pixels: np.ndarray, angle: float, scale: float, stretch: float = 1.0) -> np.ndarray:
    turned = np.array([[math.cos(angle), math.sin(angle)], [math.sin(angle), -math.cos(angle)]])
    return pixels @ (turned @ np.diag([scale, scale * stretch])).T + np.array([30.0, -50.0])


@given(angle=st.floats(-math.pi, math.pi), scale=st.floats(0.05, 2.0), count=st.sampled_from([2, 3, 5]))
def test_a_turned_and_scaled_photo_comes_back(angle: float, scale: float, count: int) -> None:
    fit = fitted(matched(laid(PIXELS[:count], angle, scale), PIXELS[:count]), FRAME)
    assert fit.ground(PIXELS) == pytest.approx(laid(PIXELS, angle, scale), abs=CENTIMETRE)
    assert fit.pixels(fit.ground(PIXELS)) == pytest.approx(PIXELS, abs=CENTIMETRE)
    assert fit.metres_per_pixel == pytest.approx(scale, rel=1e-3)
    assert fit.rms < CENTIMETRE


def test_three_points_take_a_photo_that_is_stretched_one_way() -> None:
    fit = fitted(matched(laid(PIXELS, 0.4, 0.2, 1.3)), FRAME)
    assert fit.ground(PIXELS) == pytest.approx(laid(PIXELS, 0.4, 0.2, 1.3), abs=CENTIMETRE)


def test_residuals_point_at_the_wrong_spot() -> None:
    ground = laid(PIXELS, 0.0, 0.2)
    ground[2] += (6.0, 0.0)
    fit = fitted(matched(ground), FRAME)
    assert fit.rms > 1.0
    assert max(fit.residuals) > 1.0


@pytest.mark.parametrize(
    ("pixels", "ground", "says"),
    [
        (PIXELS[:1], laid(PIXELS[:1], 0.0, 0.2), "two or more"),
        (PIXELS[:2] * 0.01, laid(PIXELS[:2], 0.0, 0.2), "far apart"),
        (PIXELS[:3] * [1, 0], laid(PIXELS[:3], 0.0, 0.2), "one line"),
        (PIXELS[:3], laid(PIXELS[:3], 0.0, 0.2)[[1, 0, 2]], "upside down"),
        (PIXELS[:2], laid(PIXELS[:2], 0.0, 80.0), "a pixel"),
    ],
)
def test_points_that_lay_no_photo_are_refused_in_words(pixels: np.ndarray, ground: np.ndarray, says: str) -> None:
    with pytest.raises(FitError, match=says):
        fitted(matched(ground, pixels), FRAME)


# --- pictures --------------------------------------------------------------------------------------------------------


def picture(kind: str, size: tuple[int, int] = (400, 300), **options: object) -> bytes:
    made = io.BytesIO()
    Image.new("RGB", size, (40, 120, 60)).save(made, kind, **options)
    return made.getvalue()


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "TIFF"])
def test_every_kind_of_picture_is_taken_and_made_small(kind: str) -> None:
    photo = opened_photo(f"air.{kind.lower()}", picture(kind, (4000, 1000)))
    assert (photo.width, photo.height, photo.name) == (2048, 512, "air")
    assert photo.points == ()
    assert sheet(photo, np.array([[0.0, 10.0], [40.0, 10.0], [40.0, 0.0], [0.0, 0.0]])).startswith(b"glTF")


def test_a_geotiff_brings_its_place_along() -> None:
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    tags[33550] = (0.5, 0.5, 0.0)
    tags[33922] = (0.0, 0.0, 0.0, 462_000.0, 5_261_000.0, 0.0)
    tags[34735] = (1, 1, 0, 1, 3072, 0, 1, 32632)
    for tag in (33550, 33922):
        tags.tagtype[tag] = 12
    tags.tagtype[34735] = 3
    photo = opened_photo("ortho.tif", picture("TIFF", tiffinfo=tags))
    frame = FieldFrame(photo.points[0].latitude_deg, photo.points[0].longitude_deg)
    fit = fitted(photo.points, frame)
    assert fit.metres_per_pixel == pytest.approx(0.5, rel=1e-3)
    assert fit.rms < CENTIMETRE


@pytest.mark.parametrize("content", [b"", b"no picture", picture("PNG")[:200], b"GIF89a" + bytes(50)])
def test_what_is_no_picture_is_refused_by_name(content: bytes) -> None:
    with pytest.raises(PhotoError, match=r"holiday\.png"):
        opened_photo("holiday.png", content)
