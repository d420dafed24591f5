"""The vocabulary: frozen records that travel from the wire to the pixel, and the driver's commands. No behaviour.

Frames and units, once for all: lengths in metres, times in seconds, angles in radians unless the name says
otherwise. Positions are (east, north) in the field frame (``geodesy.FieldFrame``). Headings turn clockwise from true
north. Roll is positive right side down, pitch positive nose up, yaw rate positive clockwise. Cross-track error is
positive when the guided point is right of the pass in the direction of travel. What may be missing is None.

Two clocks appear. ``arrival`` is the session clock: seconds since the session began, stamped by the source when the
bytes came in. ``t`` of a fix is the receiver's clock: seconds since midnight UTC of the day the stream began,
continuous over midnight; every ``dt`` of a filter is a difference of these.
"""

from guidance_app.model.arrays import FloatArray
from guidance_app.model.commands import (
    Command,
    Commanded,
    DropOffset,
    Event,
    LineHere,
    Nudge,
    OffsetKind,
    OnTheMark,
    ReverseDirection,
    SetLookAhead,
    SetWork,
    SetWorkMode,
    SkipPass,
    SourceDown,
    SourceUp,
    TakePass,
    WorkMode,
)
from guidance_app.model.known import LinkState, LinkStatus, OffsetRecord, Snapshot
from guidance_app.model.lines import Guidance, Pass, Plan, PlanCosts, Segment, SegmentKind, TurnGuide
from guidance_app.model.motion import Measurement, Pose, Prediction
from guidance_app.model.wire import (
    ATTITUDE,
    CORRECTIONS,
    RECEIVER,
    Attitude,
    Chunk,
    Fix,
    FixQuality,
    NoFix,
    Observation,
    Rejected,
    Satellite,
)
from guidance_app.model.worked import CoverageTotals, Strip, Trail

__all__ = [
    "ATTITUDE",
    "CORRECTIONS",
    "RECEIVER",
    "Attitude",
    "Chunk",
    "Command",
    "Commanded",
    "CoverageTotals",
    "DropOffset",
    "Event",
    "Fix",
    "FixQuality",
    "FloatArray",
    "Guidance",
    "LineHere",
    "LinkState",
    "LinkStatus",
    "Measurement",
    "NoFix",
    "Nudge",
    "Observation",
    "OffsetKind",
    "OffsetRecord",
    "OnTheMark",
    "Pass",
    "Plan",
    "PlanCosts",
    "Pose",
    "Prediction",
    "Rejected",
    "ReverseDirection",
    "Satellite",
    "Segment",
    "SegmentKind",
    "SetLookAhead",
    "SetWork",
    "SetWorkMode",
    "SkipPass",
    "Snapshot",
    "SourceDown",
    "SourceUp",
    "Strip",
    "TakePass",
    "Trail",
    "TurnGuide",
    "WorkMode",
]
