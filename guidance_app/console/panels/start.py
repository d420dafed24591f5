"""The start panel: a registered operation by its name, or drive now with nothing but a width."""

from typing import ClassVar

import viser

from guidance_app.console.desk import Desk, Hands, Place
from guidance_app.console.widgets import Shown, notice_html
from guidance_app.documents import Implement, Job, Operation, Receiver, Tractor
from guidance_app.language import message
from guidance_app.store import load_job

__all__ = ["Start"]


class Start:
    """Begins a drive."""

    title: ClassVar[str] = message("Start")

    def __init__(self, gui: viser.GuiApi, hands: Hands) -> None:
        self._hands = hands
        words = hands.words
        said = Shown(gui)
        store = hands.house.store
        operations = () if store is None else store.list(Operation)
        for stored in operations:
            self._offer(gui, stored.document)
        if not operations:
            nothing = words("No operation is registered yet: drive now, or set up field and machines.")
            said.show(notice_html([nothing]))
        with gui.add_folder(words("Drive now")):
            self._width = gui.add_number(
                words("{title} ({unit})", title=words("Working width"), unit="m"), 3.0, min=0.3, max=60.0, step=0.1
            )
            self._source = gui.add_text(words("Receiver"), hands.house.manager.job.receiver.source)
            now = gui.add_button(words("Drive now"), color="green")

        @now.on_click
        async def _(_: object) -> None:
            hands.later(self._drive_now)

    def _offer(self, gui: viser.GuiApi, operation: Operation) -> None:
        button = gui.add_button(f"{operation.field}: {operation.name}", color="green")

        @button.on_click
        async def _(_: object) -> None:
            self._hands.later(lambda: self._drive(operation))

    def _drive(self, operation: Operation) -> None:
        store = self._hands.house.store
        assert store is not None
        self._hands.house.drive(load_job(store, operation.name, operation.field))
        self._hands.go(Place.DRIVE)

    def _drive_now(self) -> None:
        job = Job(
            tractor=Tractor(name="Tractor"),
            implement=Implement(name="Implement", working_width=float(self._width.value)),
            receiver=Receiver(name="Receiver", source=self._source.value),
            settings=self._hands.house.settings(),
        )
        self._hands.house.drive(job)
        self._hands.go(Place.DRIVE)

    def show(self, desk: Desk) -> None:
        """Nothing here changes by itself."""
        del desk
