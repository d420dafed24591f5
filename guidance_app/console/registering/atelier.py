"""What every way of registering works with: the frame of the map, the sketch, and the two ends of a way."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import assert_never

from guidance_app.boundary import CheckedField
from guidance_app.console.desk import Hands
from guidance_app.console.registering.photo_layer import PhotoLayer
from guidance_app.documents import FieldDocument, Units
from guidance_app.geodesy import FieldFrame
from guidance_app.language import Words
from guidance_app.view.units import ACRE, ARE, HECTARE, TAN

__all__ = ["Atelier", "area_words"]


@dataclass(frozen=True, slots=True)
class Atelier:
    """Given to each way: ``offer`` shows what was made in the preview, ``cancel`` goes back to the list."""

    hands: Hands
    offer: Callable[[tuple[CheckedField, ...], str], None]
    cancel: Callable[[], None]
    layer: PhotoLayer

    def frame(self) -> FieldFrame | None:
        """The frame of the map as it is shown, else of the photo on it; None while nothing has a place on earth."""
        origin = self.hands.desk().snapshot.origin_deg
        return self.layer.frame() if origin is None else FieldFrame(*origin)

    def unique_name(self, wanted: str) -> str:
        """``wanted``, or with a number behind it when a field is called so already."""
        store = self.hands.house.store
        taken = set() if store is None else {stored.document.name for stored in store.list(FieldDocument)}
        number = 1
        name = wanted
        while name in taken:
            number += 1
            name = f"{wanted} {number}"
        return name


def area_words(square_metres: float, units: Units, words: Words) -> str:
    """An area with two decimals, whatever its size: a preview is read, not glanced at."""
    match units:
        case Units.IMPERIAL:
            return f"{words.number(square_metres / ACRE, 2)} ac"
        case Units.JAPANESE:
            return f"{words.number(square_metres / ARE, 2)} a"
        case Units.METRIC:
            return f"{words.number(square_metres / HECTARE, 2)} ha"
        case Units.TAN:
            return f"{words.number(square_metres / TAN, 2)} {words('tan')}"
        case _:
            assert_never(units)
