"""Real recordings: scored against a reference receiver's, or against themselves where there is none.

A reference that is another receiver has an origin of its own, so a constant offset is taken off first; what remains is
the relative error, which is what matters between neighbouring passes. A log with more decimals is the reference of the
same log with fewer; both have the receiver's slow error, so the filter is told that there is none. A log alone still
shows whether headings are calm: on straight stretches the heading must be that of the chord from four seconds before to
four seconds after.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from guidance_app.decode.decoder import Decoder
from guidance_app.estimation.filter import FilterSettings
from guidance_app.evaluation.estimating import estimate_recording
from guidance_app.evaluation.metrics import Score, errors_of, score, summarise, wrapped
from guidance_app.evaluation.rows import Row, at_least, at_most
from guidance_app.evaluation.smoothed import smooth_recording
from guidance_app.evaluation.tracks import Recording, Track
from guidance_app.geodesy import FieldFrame, grid_cell
from guidance_app.model import Chunk, Fix, FixQuality, FloatArray

__all__ = [
    "as_courses",
    "car_rows",
    "chord_headings",
    "fixes_of",
    "frame_of",
    "heading_consistency",
    "recording_from_fixes",
    "requantised",
    "track_from_fixes",
    "tractor_rows",
]

CM = 100.0
CHORD_S = 4.0
STRAIGHT = 0.05
"""A chord is straight when the way along it is at most this share longer."""
SHORTEST_CHORD = 4.0
REFERENCE_BASELINE = 1.0
LONGEST_BASELINE_S = 5.0
NO_WORSE = 1.01
"""Filtering a log must not lose against leaving it alone, but for a hundredth part."""


def fixes_of(data: bytes) -> list[Fix]:
    """The fixes of a whole recording, as the console's decoder reads them; times are the sentences' own."""
    decoder = Decoder()
    observations = (*decoder.feed(Chunk(0.0, data)), *decoder.finish(0.0))
    return [observation for observation in observations if isinstance(observation, Fix)]


def frame_of(fixes: Sequence[Fix]) -> FieldFrame:
    """The field frame at the first fix."""
    return FieldFrame(fixes[0].latitude_deg, fixes[0].longitude_deg)


def recording_from_fixes(fixes: Sequence[Fix], frame: FieldFrame, *, with_velocity: bool = True) -> Recording:
    """The fixes in the frame, repeated and older epochs left out.

    The velocity is kept when every fix has course and speed.
    """
    kept = list(fixes[:1])
    for fix in fixes:
        if fix.t > kept[-1].t:
            kept.append(fix)
    position = frame.array_from_lonlat([(fix.longitude_deg, fix.latitude_deg) for fix in kept])
    velocity = None
    if with_velocity and all(fix.speed is not None and fix.course is not None for fix in kept):
        velocity = np.array([(fix.speed * math.sin(fix.course), fix.speed * math.cos(fix.course)) for fix in kept])  # type: ignore[operator, arg-type]  # both are numbers by the line above
    cell = kept[0].cell
    return Recording(
        t=np.array([fix.t for fix in kept]),
        position=position,
        cell=None if cell is None else (cell[1], cell[0]),
        velocity=velocity,
        quality=kept[len(kept) // 2].quality,
    )


def requantised(fixes: Sequence[Fix], decimals: int) -> list[Fix]:
    """The fixes as a precise receiver with fewer decimals of a minute would have said them."""
    steps = 60 * 10**decimals
    return [
        replace(
            fix,
            latitude_deg=round(fix.latitude_deg * steps) / steps,
            longitude_deg=round(fix.longitude_deg * steps) / steps,
            cell=grid_cell(fix.latitude_deg, decimals),
            quality=FixQuality.RTK_FIXED,
        )
        for fix in fixes
    ]


def track_from_fixes(fixes: Sequence[Fix], frame: FieldFrame) -> Track:
    """A reference track: positions as they are, heading and speed over at least a metre on either side of each fix.

    Where no metre was driven within five seconds the heading is not known.
    """
    recording = recording_from_fixes(fixes, frame, with_velocity=False)
    t, position = recording.t, recording.position
    count = len(t)
    heading, speed = np.zeros(count), np.zeros(count)
    known = np.zeros(count, dtype=bool)
    for k in range(count):
        before, after = _baseline(t, position, k)
        step = position[after] - position[before]
        span = t[after] - t[before]
        if span > 0:
            speed[k] = float(np.hypot(*step)) / span
        if float(np.hypot(*step)) >= REFERENCE_BASELINE and span <= LONGEST_BASELINE_S:
            heading[k] = math.atan2(step[0], step[1]) % math.tau
            known[k] = True
    turned = np.zeros(count)
    if count > 2:
        change = wrapped(heading[2:] - heading[:-2]) / (t[2:] - t[:-2])
        both = known[2:] & known[:-2] & (speed[1:-1] > 0.3)
        turned[1:-1] = np.where(both, change / np.maximum(speed[1:-1], 0.3), 0.0)
    return Track(t, position[:, 0], position[:, 1], heading, speed, turned, known)


def chord_headings(fixes: Sequence[Fix], frame: FieldFrame) -> Track:
    """The fixes with the chord's direction as heading, known only on straight stretches."""
    recording = recording_from_fixes(fixes, frame, with_velocity=False)
    t, position = recording.t, recording.position
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(position, axis=0).T))))
    before = np.searchsorted(t, t - CHORD_S)
    after = np.minimum(np.searchsorted(t, t + CHORD_S, side="right") - 1, len(t) - 1)
    chord = position[after] - position[before]
    length = np.hypot(chord[:, 0], chord[:, 1])
    span = t[after] - t[before]
    straight = (way[after] - way[before]) <= (1 + STRAIGHT) * length
    known = straight & (length > SHORTEST_CHORD) & (np.abs(span - 2 * CHORD_S) < 0.5 * CHORD_S)
    return Track(
        t=t,
        east=position[:, 0],
        north=position[:, 1],
        heading=np.arctan2(chord[:, 0], chord[:, 1]) % math.tau,
        speed=length / np.maximum(span, 0.1),
        curvature=np.zeros(len(t)),
        heading_known=known,
    )


def heading_consistency(recording: Recording, fixes: Sequence[Fix], frame: FieldFrame, filter_name: str) -> float:
    """Root mean square of the filter's heading against the chord's on straight stretches, in radians."""
    errors = errors_of(as_courses(estimate_recording(recording, filter_name)), chord_headings(fixes, frame))
    rms = summarise(errors).heading_rms
    if rms is None:
        msg = "the log has no straight stretch long enough to compare headings with"
        raise ValueError(msg)
    return rms


def car_rows(receiver: Sequence[Fix], reference: Sequence[Fix]) -> list[Row]:
    """A car's receiver, and its reference rounded to four decimals, both against the reference."""
    frame = frame_of(reference)
    truth = track_from_fixes(reference, frame)
    coarse = requantised(reference, 4)
    rows: list[Row] = []
    for title, fixes, shifted in (
        ("u-blox F9K, 5 decimals, relative error", receiver, True),
        ("reference rounded to 4 decimals", coarse, False),
    ):
        protocol = f"Car with reference, 1 Hz: {title}"
        scores = _scores(recording_from_fixes(fixes, frame), truth, shifted=shifted)
        rows += _score_rows(protocol, scores)
    return rows


def tractor_rows(fine: Sequence[Fix], coarse: Mapping[str, Sequence[Fix]]) -> list[Row]:
    """A tractor's log with 4 decimals against the same with 7, and heading consistency of all 4-decimal logs.

    The first of ``coarse`` is the one that ``fine`` belongs to.
    """
    first = next(iter(coarse.values()))
    frame = frame_of(fine)
    recording = replace(recording_from_fixes(first, frame), quality=FixQuality.RTK_FIXED)
    truth = track_from_fixes(fine, frame)
    rows: list[Row] = []
    for title, given in (("", replace(recording, velocity=None)), (", with course and speed", recording)):
        scores = _scores(given, truth, shifted=False)
        rows += _score_rows(f"Tractor with 9 m implement, 1 Hz{title}: 4 decimals against 7 decimals", scores)
    protocol = "Tractor logs, 4 decimals: heading against the chord of 8 s on straight stretches"
    for name, fixes in coarse.items():
        here = frame_of(fixes)
        recording = recording_from_fixes(fixes, here, with_velocity=False)
        values = {
            label: math.degrees(heading_consistency(recording, fixes, here, label))
            for label in ("off", "quantisation_kf", "adaptive")
        }
        rows.append(
            Row(
                protocol, name, "deg", values["adaptive"], paper=values["quantisation_kf"], peer=values["off"],
                note="paper: its filter; peer: no filter",
            )
        )  # fmt: skip
    return rows


def _baseline(t: FloatArray, position: FloatArray, k: int) -> tuple[int, int]:
    """The nearest fixes around number ``k`` that are at least a metre apart and not too long ago."""
    before, after = max(k - 1, 0), min(k + 1, len(t) - 1)
    while float(np.hypot(*(position[after] - position[before]))) < REFERENCE_BASELINE:
        wider = max(before - 1, 0), min(after + 1, len(t) - 1)
        if wider == (before, after) or t[wider[1]] - t[wider[0]] > LONGEST_BASELINE_S:
            break
        before, after = wider
    return before, after


def _scores(recording: Recording, truth: Track, *, shifted: bool) -> dict[str, Score]:
    settings: FilterSettings | None = None
    tracks = {name: estimate_recording(recording, name, settings) for name in ("off", "quantisation_kf", "adaptive")}
    tracks["smoother"] = smooth_recording(recording, settings)
    return {name: score(as_courses(track), truth, remove_offset=shifted) for name, track in tracks.items()}


def as_courses(track: Track) -> Track:
    """With the direction of travel in place of the heading: what positions alone can tell of a tractor that backs."""
    return replace(track, heading=np.where(track.speed < 0, track.heading + math.pi, track.heading) % math.tau)


def _score_rows(protocol: str, scores: Mapping[str, Score]) -> list[Row]:
    """Adaptive and smoother; the column of the paper is its filter on the same log, that of the peer no filter."""
    paper, raw = scores["quantisation_kf"], scores["off"]
    rows = []
    for name in ("adaptive", "smoother"):
        ours = scores[name]
        goal = at_most(round(NO_WORSE * raw.rms * CM, 2)) if name == "adaptive" else None
        rows.append(Row(protocol, f"{name}, RMS", "cm", ours.rms * CM, paper.rms * CM, raw.rms * CM, goal=goal))
        rows.append(
            Row(
                protocol, f"{name}, 95 %", "cm", ours.percentile_95 * CM, paper.percentile_95 * CM,
                raw.percentile_95 * CM,
            )
        )  # fmt: skip
        if ours.within_ellipse is not None:
            row = Row(protocol, f"{name}, inside its 95 % ellipse", "%", 100 * ours.within_ellipse, goal=at_least(90))
            rows.append(row)
        headings = [one.heading_rms for one in (ours, paper, raw)]
        if None not in headings:
            degrees = [math.degrees(value) for value in headings if value is not None]
            rows.append(Row(protocol, f"{name}, heading", "deg", degrees[0], degrees[1], degrees[2]))
    return rows
