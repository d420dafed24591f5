"""The screen: the shared ground, one scene and one set of panels a client, and the loop that redraws them.

One thread draws everything. It looks at the newest snapshot about 25 times a second and skips what it missed; pictures
between two fixes are carried on by the pose's own motion. Callbacks of viser run on its own loop: they post a command
or leave a wish, which the loop takes at its next round. A client that has gone is forgotten; whatever happens while one
client is drawn, the others are drawn on.
"""

import logging
import threading
import time
from collections.abc import Callable

import viser

from guidance_app.console.clock import shown_instant
from guidance_app.console.desk import Desk, Hands, Panel, Place, WheelHands
from guidance_app.console.ground import WORLD, Ground
from guidance_app.console.house import House
from guidance_app.console.moving import ClientScene, Models
from guidance_app.console.panels import HEAD, PANELS, SETUP_PANELS
from guidance_app.console.sketch import Sketch
from guidance_app.console.wheel import Helm
from guidance_app.language import Words, words_for
from guidance_app.model import Command, Snapshot
from guidance_app.view.camera import ViewMode
from guidance_app.view.colours import palette_of

__all__ = ["PANEL_WIDTH", "TICK_S", "Screen"]

log = logging.getLogger(__name__)

TICK_S = 0.04
PANELS_S = 0.25
"""Words change four times a second: faster, nobody reads them."""

STOP_S = 5.0
TOLD_S = 6.0
"""So long good news stays."""
PANEL_WIDTH = 460.0
BRAND = (20, 140, 60)


class _Client:
    """One browser: its scene, its panels, where it is, and the wishes of its fingers."""

    def __init__(self, handle: viser.ClientHandle, scene: ClientScene, place: Place) -> None:
        self.handle = handle
        self.scene = scene
        self.sketch = Sketch(handle, lambda: self.scene.world, WORLD)
        self.panels: list[Panel] = []
        self.place: Place | None = None
        self.wished_place = place
        self.wished_view: ViewMode | None = None
        self.wished_back = False
        self.panels_due = 0.0
        self.leaving: list[Callable[[], None]] = []
        self.failed = False

    def again(self, scene: ClientScene) -> None:
        """Another drive: the scene is new, and at the wheel the panels too. Where things are set up one sees it all."""
        self.scene = scene
        self.sketch.forget()
        if self.place is Place.DRIVE:
            self.place = None
        else:
            self.wished_view = ViewMode.WHOLE_FIELD

    def leave_panels(self) -> None:
        """Lets go of what the panels hold outside themselves: what they listen to, the files they await."""
        leaving, self.leaving = self.leaving, []
        self.panels = []
        for leave in leaving:
            try:
                leave()
            except Exception:
                log.exception("a panel could not be left in good order")

    def take_wishes(self) -> None:
        """Does what fingers have asked for since the last redraw."""
        view, self.wished_view = self.wished_view, None
        back, self.wished_back = self.wished_back, False
        if view is not None:
            self.scene.look(view)
        elif back:
            self.scene.bring_back()


class Screen:
    """Scene and panels on viser's server, of whatever the house drives."""

    def __init__(self, server: viser.ViserServer, house: House) -> None:
        self._server = server
        self._house = house
        self._session = house.manager
        self._episode = self._session.episode
        self._job = self._session.job
        self._night = self._job.settings.night
        self._wished_night = self._night
        self._models = Models.of(self._job)
        self._ground = Ground(server, self._job, palette_of(night=self._night))
        self._clients: dict[int, _Client] = {}
        self._arrived: list[viser.ClientHandle] = []
        self._gone: list[_Client] = []
        self._helm = Helm(time.monotonic)
        self._lock = threading.Lock()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="screen", daemon=True)

    @property
    def clients(self) -> int:
        """How many browsers are drawn."""
        return len(self._clients)

    @property
    def night(self) -> bool:
        """True while the night's colours are shown."""
        return self._night

    def start(self) -> None:
        """Begins to draw, for those who are there and those who come."""
        self.attach()
        self._thread.start()

    def attach(self) -> None:
        """Draws the ground and awaits clients; ``start`` does this and then calls ``tick`` for ever."""
        self._theme()
        self._ground.show(self._session.snapshot())
        self._server.on_client_connect(self._arrive)
        self._server.on_client_disconnect(self._leave)

    def close(self) -> None:
        """Ends the loop and waits for it; again is harmless."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join(STOP_S)

    # --- clients come and go, on viser's threads -------------------------------------------------------------------

    def _arrive(self, handle: viser.ClientHandle) -> None:
        with self._lock:
            if not self._stop.is_set():
                self._arrived.append(handle)

    def _leave(self, handle: viser.ClientHandle) -> None:
        with self._lock:
            self._arrived = [one for one in self._arrived if one is not handle]
        self._forget(handle.client_id)

    def _forget(self, number: int) -> None:
        """A browser has gone; the drive goes on as it was."""
        gone = self._clients.pop(number, None)
        if gone is not None:
            with self._lock:
                self._gone.append(gone)
        self._helm.left(number)

    # --- the loop --------------------------------------------------------------------------------------------------

    def _run(self) -> None:
        due = time.monotonic()
        while not self._stop.wait(max(0.0, due - time.monotonic())):
            due = max(due + TICK_S, time.monotonic() + TICK_S / 4)
            try:
                self.tick()
            except Exception:
                log.exception("a redraw failed; the next one follows")

    def tick(self) -> None:
        """One redraw of everything."""
        self._follow_the_house()
        snapshot = self._session.snapshot()
        now = shown_instant(self._session, snapshot)
        self._welcome()
        self._change_light()
        self._ground.show(snapshot)
        for client in list(self._clients.values()):
            try:
                self._draw(client, snapshot, now)
                client.failed = False
            except Exception as error:  # noqa: BLE001 - whatever fails for one client, the others are drawn
                self._after_failure(client, error)

    def _after_failure(self, client: _Client, error: Exception) -> None:
        """A client that has gone is forgotten; one that is still there is drawn again at the next redraw.

        viser's queue is not safe against two threads at every moment: now and then a redraw fails that way, once.
        """
        number = client.handle.client_id
        if number not in self._server.get_clients():
            self._forget(number)
        elif not client.failed:
            log.error("client %d could not be drawn; the next redraw tries again", number, exc_info=error)
        client.failed = True

    def _follow_the_house(self) -> None:
        """When something else is driven, shared ground and every client's scene are made anew."""
        if self._session.episode == self._episode:
            return
        self._episode = self._session.episode
        self._job = self._session.job
        self._models = Models.of(self._job)
        self._server.scene.reset()
        palette = palette_of(night=self._night)
        self._ground = Ground(self._server, self._job, palette)
        for client in list(self._clients.values()):
            client.handle.scene.reset()
            client.again(ClientScene(client.handle, self._job, self._models, palette))

    def _draw(self, client: _Client, snapshot: Snapshot, now: float) -> None:
        client.take_wishes()
        if client.wished_place is not client.place:
            self._make_panels(client, client.wished_place)
        client.scene.draw(snapshot, now, self._ground)
        moment = time.monotonic()
        if moment >= client.panels_due:
            client.panels_due = moment + PANELS_S
            desk = self._desk(client, snapshot, now)
            for panel in client.panels:
                panel.show(desk)

    def _welcome(self) -> None:
        with self._lock:
            arrived, self._arrived = self._arrived, []
            gone, self._gone = self._gone, []
        for client in gone:
            client.leave_panels()
        for handle in arrived:
            try:
                scene = ClientScene(handle, self._job, self._models, palette_of(night=self._night))
                place = Place.SETUP if self._session.idle else Place.DRIVE
                self._clients[handle.client_id] = _Client(handle, scene, place)
                self._helm.came(handle.client_id)
            except Exception:
                if handle.client_id in self._server.get_clients():
                    log.exception("client %d could not be welcomed", handle.client_id)

    # --- day and night ---------------------------------------------------------------------------------------------

    def _wish_night(self, night: bool) -> None:
        self._wished_night = night

    def _change_light(self) -> None:
        if self._wished_night == self._night:
            return
        self._night = self._wished_night
        self._theme()
        palette = palette_of(night=self._night)
        self._ground.set_palette(palette)
        for client in list(self._clients.values()):
            client.scene.set_palette(palette)

    def _theme(self) -> None:
        self._server.gui.configure_theme(
            dark_mode=self._night, show_logo=False, show_share_button=False, brand_color=BRAND
        )

    # --- panels ----------------------------------------------------------------------------------------------------

    def _desk(self, client: _Client, snapshot: Snapshot, now: float) -> Desk:
        replay = self._session.replay
        return Desk(
            snapshot=snapshot,
            now=now,
            units=self._session.job.settings.units,
            mode=client.scene.mode,
            night=self._night,
            replay=None if replay is None else replay.state,
        )

    def _hands(self, client: _Client) -> Hands:
        def look(mode: ViewMode) -> None:
            client.wished_view = mode

        def bring_back() -> None:
            client.wished_back = True

        def go(place: Place) -> None:
            client.wished_place = place

        def soon() -> None:
            client.panels_due = 0.0

        def at_leaving(leave: Callable[[], None]) -> None:
            client.leaving.append(leave)

        def desk() -> Desk:
            snapshot = self._session.snapshot()
            return self._desk(client, snapshot, shown_instant(self._session, snapshot))

        def tell(title: str, body: str = "", *, bad: bool = False) -> None:
            seconds = None if bad else TOLD_S
            client.handle.add_notification(title, body, auto_close_seconds=seconds, color="red" if bad else "green")

        words = words_for(self._house.settings().language)
        wheel = self._wheel_hands(client, words, tell)

        def post(command: Command) -> None:
            if wheel.mine():
                self._session.post(command)

        return Hands(
            post=post,
            look=look,
            bring_back=bring_back,
            set_night=self._wish_night,
            desk=desk,
            replay=self._session.replay,
            words=words,
            house=self._house,
            sketch=client.sketch,
            later=lambda work: self._house.later(work, lambda why: tell(words("Not done"), words.say(why), bad=True)),
            tell=tell,
            go=go,
            renew=self._renew,
            soon=soon,
            at_leaving=at_leaving,
            wheel=wheel,
        )

    def _wheel_hands(self, client: _Client, words: Words, tell: Callable[..., None]) -> WheelHands:
        helm, number = self._helm, client.handle.client_id

        def mine() -> bool:
            if helm.has(number):
                return True
            tell(words("Not done"), words("Another tablet has the wheel: ask for it above."), bad=True)
            return False

        return WheelHands(
            view=lambda: helm.view(number),
            mine=mine,
            ask=lambda: helm.ask(number),
            give=lambda: helm.give(number),
            keep=lambda: helm.keep(number),
        )

    def _renew(self) -> None:
        for client in list(self._clients.values()):
            client.place = None

    def _make_panels(self, client: _Client, place: Place) -> None:
        """The head in viser's main panel, then the tabs.

        At the wheel they have a panel of their own below it, which a phone shows folded; in the setup they are part
        of the main panel.
        """
        client.place = place
        client.wished_view = ViewMode.WHOLE_FIELD if place is Place.SETUP else ViewMode.DRIVER
        client.leave_panels()
        client.sketch.clear()
        gui, hands = client.handle.gui, self._hands(client)
        gui.reset()
        gui.set_panel_label(self._title(hands.words) if place is Place.DRIVE else hands.words("Setup"))
        main = gui.main_panel
        main.dock_right()
        main.set_width(PANEL_WIDTH)
        client.panels.append(HEAD[place](gui, hands))
        tabs = gui.add_panel() if place is Place.DRIVE else gui.add_tab_group()
        for name, panel in (PANELS if place is Place.DRIVE else SETUP_PANELS).items():
            if self._is_wanted(name):
                with tabs.add_tab(hands.words(panel.title)):
                    client.panels.append(panel(gui, hands))
        if isinstance(tabs, viser.PanelHandle):
            tabs.dock_below(main)

    def _is_wanted(self, name: str) -> bool:
        """Whether a panel has anything to do in this drive: there is a recording, a plan, or none."""
        match name:
            case "replay":
                return self._session.replay is not None
            case "rest":
                return self._session.snapshot().plan is not None
            case "line":
                return self._session.snapshot().plan is None
            case _:
                return True

    def _title(self, words: Words) -> str:
        field = self._job.field.name if self._job.field is not None else words("No field")
        operation = self._job.operation.name if self._job.operation is not None else self._job.implement.name
        return f"{field} · {operation}"
