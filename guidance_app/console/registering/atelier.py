"""What every way of registering works with: the frame of the map, the sketch, and the two ends of a way."""

from collections.abc import Callable
from dataclasses import dataclass

from guidance_app.boundary import CheckedField
from guidance_app.console.desk import Hands
from guidance_app.console.registering.photo_layer import PhotoLayer
from guidance_app.documents import FieldDocument
from guidance_app.geodesy import FieldFrame

__all__ = ["Atelier"]


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
