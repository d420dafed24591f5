"""Outlines seen from the tractor: true sizes, and the ghost lies where the look-ahead leads."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.snapshots import field_job, field_snapshot

from guidance_app.estimation.prediction import Predictor, pose_after
from guidance_app.estimation.reference_point import ImplementPoint
from guidance_app.model import Pose, Snapshot
from guidance_app.view.outlines import (
    Place,
    arc_strokes,
    ghost_strokes,
    hollow_strokes,
    implement_place,
    in_body,
    ring_strokes,
    tractor_outline,
    working_edge,
)

MILLIMETRE = 1e-3
DECIMETRE = 0.1
JOB = field_job()


def driving(
    heading: float, curvature: float = 0.0, speed: float = 2.5, *, trailed: bool = False
) -> tuple[Snapshot, ImplementPoint]:
    """A snapshot whose prediction and implement the real estimators have made."""
    job = field_job(trailed=trailed)
    point, predictor = ImplementPoint(job.implement), Predictor()
    pose = Pose(0.0, 0.0, 30.0, 40.0, heading, speed, curvature=curvature)
    for k in range(40):
        t = 0.1 * (k - 39)
        turned = heading + curvature * speed * t
        pose = Pose(
            t,
            t,
            30.0 + speed * t * math.sin((heading + turned) / 2),
            40.0 + speed * t * math.cos((heading + turned) / 2),
            turned,
            speed,
            curvature=curvature,
        )
        implement = point.step(pose)
    snapshot = field_snapshot(0.0, pose=pose, implement=implement, prediction=predictor.step(pose, 1.5))
    return snapshot, point


@given(st.floats(-math.pi, math.pi), st.floats(-50, 50), st.floats(-50, 50))
def test_ahead_is_x_and_left_is_y(heading: float, forward: float, left: float) -> None:
    pose = Pose(0.0, 0.0, 12.0, -7.0, heading, 1.0)
    east = 12.0 + forward * math.sin(heading) - left * math.cos(heading)
    north = -7.0 + forward * math.cos(heading) + left * math.sin(heading)
    place = in_body(pose, east, north, heading - 0.1)
    assert (place.x, place.y, place.yaw) == pytest.approx((forward, left, 0.1), abs=MILLIMETRE)


def test_the_outlines_have_the_documents_sizes() -> None:
    tractor = JOB.tractor
    outline = tractor_outline(tractor)
    assert outline[:, 0].max() > tractor.wheelbase
    assert np.ptp(outline[:, 1]) == pytest.approx(tractor.track_width + 0.5)
    edge = working_edge(JOB.implement, Place(-1.5, 0.0, 0.0))
    assert edge.shape == (JOB.implement.sections, 2, 3)
    assert np.ptp(edge[..., 1]) == pytest.approx(JOB.implement.working_width)
    assert edge[:, :, 0] == pytest.approx(-1.5)


def test_an_implement_to_the_right_lies_to_the_right() -> None:
    aside = JOB.implement.model_copy(update={"offset_right": 2.0})
    place = implement_place(replace(field_snapshot(), implement=None), aside)
    assert (place.x, place.y) == (-1.5, -2.0)


@pytest.mark.parametrize("heading", [0.0, 1.0, -2.5])
def test_the_ghost_of_a_mounted_implement_is_where_the_estimator_puts_it(heading: float) -> None:
    snapshot, _ = driving(heading, curvature=0.08)
    ghost = ghost_strokes(snapshot, JOB.tractor, JOB.implement)
    assert snapshot.prediction is not None
    assert snapshot.pose is not None
    meant = in_body(snapshot.pose, *ImplementPoint(JOB.implement).step(snapshot.prediction.pose))
    drawn = ghost[-4:].reshape(-1, 3)[:, :2].mean(axis=0)
    assert drawn == pytest.approx((meant.x, meant.y), abs=MILLIMETRE)


@pytest.mark.parametrize("curvature", [0.0, 0.06, -0.1])
@pytest.mark.parametrize("speed", [2.5, 1.0])
def test_the_ghost_of_a_trailed_implement_is_where_the_estimator_will_put_it(curvature: float, speed: float) -> None:
    job = field_job(trailed=True)
    snapshot, point = driving(0.4, curvature, speed, trailed=True)
    assert snapshot.pose is not None
    for k in range(1, 16):
        reached = point.step(pose_after(snapshot.pose, 0.1 * k))
    meant = in_body(snapshot.pose, *reached)
    drawn = ghost_strokes(snapshot, job.tractor, job.implement)[-4:].reshape(-1, 3)[:, :2].mean(axis=0)
    assert drawn == pytest.approx((meant.x, meant.y), abs=DECIMETRE)


def test_the_arc_begins_at_the_tractor_and_ends_at_the_ghost() -> None:
    snapshot, _ = driving(0.7, curvature=0.05)
    arc = arc_strokes(snapshot)
    assert arc[0, 0, :2] == pytest.approx((0.0, 0.0), abs=MILLIMETRE)
    assert arc[-1, 1, 0] == pytest.approx(3.75, abs=DECIMETRE)
    assert arc[-1, 1, 1] < 0.0


def test_reversing_the_ghost_lies_behind() -> None:
    snapshot, _ = driving(0.0, speed=-1.5, trailed=True)
    assert arc_strokes(snapshot)[-1, 1, 0] < -1.5


def test_without_a_prediction_nothing_lies_ahead() -> None:
    standing = replace(field_snapshot(), prediction=None)
    assert len(arc_strokes(standing)) == 0
    assert len(ghost_strokes(standing, JOB.tractor, JOB.implement)) == 0


def test_hollow_outlines_are_tractor_and_implement() -> None:
    strokes = hollow_strokes(JOB.tractor, JOB.implement, Place(-1.5, 0.0, 0.0))
    assert np.ptp(strokes[..., 1]) == pytest.approx(JOB.implement.working_width)
    assert np.hypot(*ring_strokes(2.0)[:, 0, :2].T) == pytest.approx(2.0)
