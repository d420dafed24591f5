"""A drive as ISOXML of version 4: task data with field, guidance lines, device and task, and the time log in binary.

The log holds the filtered position, the work state (DDI 141), the working width (DDI 67) and the speed over ground
(DDI 397, mm/s); the task's totals are the worked area (DDI 116) and the effective time (DDI 119).
"""

from collections.abc import Sequence
from datetime import UTC, datetime
from itertools import pairwise

from guidance_app.exchange.drives.record import DriveEpoch, DriveExport
from guidance_app.exchange.isoxml import TASKDATA, designator, field_element, task_data
from guidance_app.exchange.shapefile_format import archive_of
from guidance_app.exchange.time_log import Instant, LoggedValue, written_log
from guidance_app.exchange.xml_tree import quoted

__all__ = ["LAYOUT", "written"]

LOG = "TLG00001"
ELEMENT = "DET-1"
WORK_STATE, WIDTH, SPEED, AREA, EFFECTIVE_TIME = 141, 67, 397, 116, 119
LAYOUT = (LoggedValue(WORK_STATE, ELEMENT), LoggedValue(WIDTH, ELEMENT), LoggedValue(SPEED, ELEMENT))
NAMES = (
    (WORK_STATE, "Work state"),
    (WIDTH, "Working width"),
    (SPEED, "Speed"),
    (AREA, "Area"),
    (EFFECTIVE_TIME, "Time"),
)
COMPLETED = 4
EFFECTIVE = 4
LONGEST_STEP = 2.0
"""Seconds; what is longer between two epochs is not counted as working time."""


def written(drive: DriveExport) -> bytes:
    """An archive with TASKDATA.XML and, if the receiver had told its date, the time log."""
    timed = [epoch for epoch in drive.epochs if epoch.utc is not None]
    files = {}
    elements = [] if drive.field is None else [field_element(drive.field)]
    elements.append(_device(drive))
    elements.append(_task(drive, timed))
    files[f"TASKDATA/{TASKDATA}"] = task_data(elements)
    if timed:
        width = round(drive.working_width * 1000)
        head, body = written_log(LAYOUT, [_instant(epoch, width) for epoch in timed])
        files |= {f"TASKDATA/{LOG}.XML": head, f"TASKDATA/{LOG}.BIN": body}
    return archive_of(files)


def _instant(epoch: DriveEpoch, width: int) -> Instant:
    place = epoch.filtered or epoch.raw
    values = {0: int(epoch.working), 1: width if epoch.working else 0}
    if place.speed is not None:
        values[2] = round(abs(place.speed) * 1000)
    members = {"D": float(epoch.quality)}
    if epoch.satellites is not None:
        members["G"] = float(epoch.satellites)
    position = place.latitude_deg, place.longitude_deg
    return Instant(epoch.utc or 0.0, position, epoch.altitude, members, values)


def _device(drive: DriveExport) -> str:
    data = "".join(
        f'<DPD A="{number}" B="{ddi:04X}" C="1" D="8" E={quoted(name)}/>'
        for number, (ddi, name) in enumerate(NAMES, start=2)
    )
    objects = "".join(f'<DOR A="{number}"/>' for number in range(2, 2 + len(NAMES)))
    return (
        f'<DVC A="DVC-1" B={quoted(designator(drive.implement))} D="A000860000000000" F="00000000000000"'
        f' G="FF000000406E65"><DET A="{ELEMENT}" B="1" C="1" D={quoted(designator(drive.implement))} E="1" F="0">'
        f"{objects}</DET>{data}</DVC>"
    )


def _task(drive: DriveExport, timed: Sequence[DriveEpoch]) -> str:
    field = "" if drive.field is None else ' E="PFD1"'
    inside = ""
    if timed:
        totals = {AREA: round(drive.worked_area), EFFECTIVE_TIME: round(_working_seconds(timed))}
        values = "".join(f'<DLV A="{ddi:04X}" B="{value}" C="{ELEMENT}"/>' for ddi, value in totals.items())
        begin, end = (_moment(epoch) for epoch in (timed[0], timed[-1]))
        inside = f'<TIM A="{begin}" B="{end}" D="{EFFECTIVE}">{values}</TIM><TLG A="{LOG}" C="1"/>'
    allocation = '<DAN A="A000860000000000" C="DVC-1"/>'
    return f'<TSK A="TSK1" B={quoted(designator(drive.name))}{field} G="{COMPLETED}">{inside}{allocation}</TSK>'


def _moment(epoch: DriveEpoch) -> str:
    return datetime.fromtimestamp(round(epoch.utc or 0.0), UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def _working_seconds(timed: Sequence[DriveEpoch]) -> float:
    steps = ((after.utc or 0.0) - (before.utc or 0.0) for before, after in pairwise(timed) if after.working)
    return sum(step for step in steps if 0 < step <= LONGEST_STEP)
