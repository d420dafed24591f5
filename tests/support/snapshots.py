"""Snapshots of a field at work, built by hand, and a session whose clock a test sets."""

import math
import threading
from dataclasses import replace
from typing import Any

import numpy as np

from guidance_app.documents import FieldDocument, Geometry, HitchKind, Implement, Job, Receiver, Settings, Tractor
from guidance_app.geodesy import FieldFrame
from guidance_app.model import (
    CoverageTotals,
    Fix,
    FixQuality,
    FloatArray,
    Guidance,
    LinkState,
    LinkStatus,
    Pass,
    Plan,
    PlanCosts,
    Pose,
    Prediction,
    Segment,
    SegmentKind,
    SessionState,
    Snapshot,
    Strip,
    Trail,
    TurnGuide,
)
from support.sessions import HandSession

__all__ = ["FIELD", "TREES", "SetSession", "field_job", "field_snapshot", "straight_passes", "strip", "trail"]

ORIGIN_DEG = (47.5, 8.5)
PATIENCE_S = 40.0
FIELD = np.array([[0.0, 0.0], [120.0, 0.0], [150.0, 200.0], [0.0, 180.0], [0.0, 0.0]])
TREES = np.array([[60.0, 80.0], [70.0, 80.0], [70.0, 90.0], [60.0, 90.0], [60.0, 80.0]])


def field_job(settings: Settings | None = None, *, trailed: bool = False, width: float = 6.0, **tractor: float) -> Job:
    """The documents of a job on ``FIELD``."""
    ring = [(float(lon), float(lat)) for lon, lat in FieldFrame(*ORIGIN_DEG).lonlat_from_array(FIELD)]
    hitch = {"hitch": HitchKind.TRAILED, "offset_back": 5.0, "drawbar": 4.0} if trailed else {}
    return Job(
        tractor=Tractor(name="Tractor", **tractor),
        implement=Implement(name="Implement", working_width=width, sections=3, **hitch),
        receiver=Receiver(name="Receiver"),
        field=FieldDocument(name="Long Acre", boundary=Geometry(coordinates=[[*ring[:-1], ring[0]]]), entrance=ring[0]),
        settings=settings or Settings(),
    )


def straight_passes(count: int, spacing: float = 6.0, south: float = 12.0, north: float = 160.0) -> tuple[Pass, ...]:
    """Passes 1..n from west to east, each driven north."""
    return tuple(
        Pass(n, np.array([[6.0 + (n - 1) * spacing, south], [6.0 + (n - 1) * spacing, north]]), order=n - 1)
        for n in range(1, count + 1)
    )


def strip(index: int, points: FloatArray, width: float = 6.0, *, sealed: bool = True) -> Strip:
    """Worked ground along points of shape (N, 2)."""
    step = np.gradient(points, axis=0)
    right = np.column_stack([step[:, 1], -step[:, 0]]) / np.hypot(*step.T)[:, None]
    return Strip(index, points - right * width / 2, points + right * width / 2, 1, sealed=sealed)


def trail(pieces: list[Any], open_piece: Any = None) -> Trail:
    """All these pieces, and one that still grows."""
    return Trail(pieces, len(pieces), None if open_piece is None else lambda: open_piece)


def _plan(passes: tuple[Pass, ...]) -> Plan:
    segments = tuple(
        Segment(SegmentKind.PASS, one.number, one.points, implement_down=True, length=150.0) for one in passes
    )
    mainland = (np.array([[12.0, 12.0], [110.0, 12.0], [130.0, 170.0], [12.0, 165.0], [12.0, 12.0]]),)
    costs = PlanCosts(3000.0, 300.0, 11, 0, 30.0, 0.97, 0.01, 200.0)
    return Plan("round-trip", 0.0, 6.0, segments, (mainland,), costs)


def field_snapshot(
    at: float = 100.0,
    *,
    pose: Pose | None = None,
    target: int = 3,
    count: int = 12,
    turn: TurnGuide | None = None,
    **members: Any,
) -> Snapshot:
    """A tractor on pass ``target`` of ``count`` that drives north at 2.5 m/s, with all there is to show."""
    passes = straight_passes(count)
    east = float(passes[target - 1].points[0, 0])
    pose = pose or Pose(at, at, east + 0.1, 60.0, 0.0, 2.5, covariance=(0.04, 0.0, 0.09))
    later = replace(pose, t=at + 1.5, arrival=at + 1.5, north=pose.north + 1.5 * pose.speed * math.cos(pose.heading))
    arc = np.linspace((pose.east, pose.north), (later.east, later.north), 16)
    guidance = Guidance(
        target=passes[target - 1],
        cross_track=0.1,
        heading_error=0.0,
        along_track=48.0,
        against=False,
        remaining=100.0,
        next_number=target + 1 if target < count else None,
        turn=turn,
        on_pass=True,
        done=frozenset(range(1, target)),
        count=count,
    )
    snapshot = Snapshot(
        sequence=1,
        arrival=at,
        link=LinkState(LinkStatus.FIX, since=1.0, last_data=at, sentences=3000, rejected=2, fixes=1000),
        fix=Fix(at, at, *ORIGIN_DEG, FixQuality.RTK_FIXED, cell=(0.0185, 0.0126), satellites=17, hdop=0.7),
        fix_interval=0.1,
        pose=pose,
        implement=(pose.east, pose.north - 1.5, pose.heading),
        prediction=Prediction(1.5, later, arc, cross_track=0.1, heading_error=0.0),
        guidance=guidance,
        origin_deg=ORIGIN_DEG,
        field_rings=(FIELD, TREES),
        passes=passes,
        plan=_plan(passes),
        ground_version=1,
        working=True,
        totals=CoverageTotals(
            worked=5200.0, overlap=90.0, left=18_000.0, headland=400.0, distance=900.0, working_s=360.0
        ),
        filter_name="adaptive",
        state=SessionState.DRIVING,
        sections=(True, True, True),
        pass_totals=CoverageTotals(worked=310.0, overlap=12.0, left=40.0),
    )
    return replace(snapshot, **members)


class SetSession(HandSession):
    """A session whose clock stands where the test has set it, in ``instant``."""

    def __init__(self, snapshot: Snapshot, job: Job | None = None) -> None:
        super().__init__(first=snapshot)
        self.job = job or field_job()
        self.instant = snapshot.arrival
        self._posted = threading.Condition()

    def post(self, command: object) -> None:
        with self._posted:
            super().post(command)
            self._posted.notify_all()

    def until_posted(self, command: object) -> None:
        """Waits for this command."""
        with self._posted:
            assert self._posted.wait_for(lambda: command in self.commands, PATIENCE_S), f"{command} was not posted"

    def now(self) -> float:
        return self.instant
