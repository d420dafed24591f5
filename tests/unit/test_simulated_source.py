"""``sim:`` is a receiver like any other: options with bounds, an epoch a chunk, no end."""

import itertools
import threading
from typing import Any

import numpy as np
import pytest
import shapely

from guidance_app.boundary import frame_of, polygon_in
from guidance_app.decode.decoder import Decoder
from guidance_app.documents import FieldDocument, Geometry, Job, Method
from guidance_app.model import Chunk, Fix, SourceUp
from guidance_app.simulation.job import START
from guidance_app.simulation.sample import sample_job
from guidance_app.sources import SourceError, open_receiver, open_source
from guidance_app.sources.simulated import open_simulated, open_simulated_on, sample_drive


def chunks_of(uri: str, count: int) -> list[Chunk]:
    events = open_simulated(uri).events(threading.Event())
    first, *rest = itertools.islice(events, count + 1)
    assert isinstance(first, SourceUp)
    assert all(isinstance(event, Chunk) for event in rest)
    return [event for event in rest if isinstance(event, Chunk)]


def fixes_of(chunks: list[Chunk]) -> list[Fix]:
    decoder = Decoder()
    seen = [one for chunk in chunks for one in decoder.feed(chunk)]
    assert decoder.rejected == {}
    return [one for one in seen if isinstance(one, Fix)]


def test_chunks_are_epochs_with_their_own_times() -> None:
    chunks = chunks_of("sim:?rate=10", 200)
    assert [chunk.arrival for chunk in chunks] == pytest.approx(list(np.arange(200) / 10))
    fixes = fixes_of(chunks)
    assert np.diff([fix.t for fix in fixes]) == pytest.approx(0.1)


def test_every_option_does_something() -> None:
    plain = chunks_of("sim:", 60)
    assert plain == chunks_of("sim:?seed=1&rate=5&decimals=4&speed=9&sentences=GGA,RMC,VTG", 60)
    for option in ("seed=2", "rate=10", "decimals=7", "speed=4", "sentences=GGA,HDT,ROT"):
        assert chunks_of(f"sim:?{option}", 60) != plain, option
    heading = fixes_of(chunks_of("sim:?sentences=gga,hdt", 5))[0].heading
    assert heading is not None
    cell = fixes_of(chunks_of("sim:?decimals=7", 5))[0].cell
    assert cell is not None
    assert cell[0] == pytest.approx(0.0001852)


def test_it_drives_the_field_over_and_over() -> None:
    job = sample_job()
    drive = sample_drive(job)
    round_m = sum(segment.length for segment in (*drive.passes, *drive.way_back))
    count = int(1.25 * round_m / (15 / 3.6) * 2)  # more than a round at 15 km/h, had it no turns
    fixes = fixes_of(chunks_of("sim:?rate=2&speed=15", 2 * count))
    places = np.array([drive.frame.east_north_from_degrees(fix.latitude_deg, fix.longitude_deg) for fix in fixes])
    beginning = drive.passes[0].points[0]
    near = np.hypot(*(places - beginning).T) < 3.0
    visits = int((np.diff(near.astype(int)) == 1).sum())
    assert visits >= 1
    steps = np.hypot(*np.diff(places, axis=0).T)
    assert steps.max() < 4.0  # it never jumps


def job_on(field: FieldDocument, **wishes: Any) -> Job:
    sample = sample_job()
    assert sample.operation is not None
    return sample.model_copy(update={"field": field, "operation": sample.operation.model_copy(update=wishes)})


@pytest.mark.parametrize("method", [Method.SURROUNDING, Method.LINE])
def test_the_tractor_of_a_job_drives_its_field_by_its_plan_and_then_stands(method: Method) -> None:
    ring = [(8.5, 47.5), (8.5009, 47.5), (8.5009, 47.5006), (8.5, 47.5006), (8.5, 47.5)]
    field = FieldDocument(name="Far from the sample", boundary=Geometry(coordinates=[ring]))
    source = open_simulated_on("sim:?rate=1&speed=15", job_on(field, method=method, turning_space=None))
    assert source.description == "simulated receiver on the field 'Far from the sample'"
    assert source.way is not None
    chunks = [event for event in itertools.islice(source.events(threading.Event()), 900) if isinstance(event, Chunk)]
    frame = frame_of(field.boundary)
    places = [frame.east_north_from_degrees(fix.latitude_deg, fix.longitude_deg) for fix in fixes_of(chunks)]
    ground = polygon_in(frame, field.boundary)
    inside = shapely.contains_xy(ground.buffer(1.5), places)
    assert inside.all()
    track = shapely.LineString(places)
    worked = shapely.unary_union([shapely.LineString(one.points) for one in source.way.segments if one.implement_down])
    assert worked.intersection(track.buffer(1.5)).length > 0.97 * worked.length
    assert np.ptp(places[-20:], axis=0).max() < 2.0  # it has come to its end and stands


def test_a_drive_that_goes_on_does_not_go_back_in_time() -> None:
    before = open_simulated_on("sim:", sample_job())
    after = open_simulated_on("sim:", sample_job())
    assert before.way is not None
    assert after.way is not None
    assert after.way.start >= before.way.start > START
    first = fixes_of([one for one in itertools.islice(after.events(threading.Event()), 9) if isinstance(one, Chunk)])[0]
    day = after.way.start.hour * 3600 + after.way.start.minute * 60 + after.way.start.second
    assert first.t % 86_400 == pytest.approx(day, abs=1.0)


def test_a_drive_that_goes_on_begins_with_the_pass_under_way() -> None:
    whole = open_simulated_on("sim:", sample_job()).way
    assert whole is not None
    works = [one for one in whole.segments if one.implement_down]
    late = open_simulated_on("sim:", sample_job(), works[3].number).way
    assert late is not None
    assert late.segments[0].number == works[3].number
    assert late.segments[0].points.tolist() == works[3].points.tolist()
    unknown = open_simulated_on("sim:", sample_job(), 999).way
    assert unknown is not None
    assert len(unknown.segments) == len(whole.segments)


def test_a_job_without_a_field_is_driven_on_the_sample() -> None:
    job = sample_job().model_copy(update={"field": None, "operation": None})
    assert open_simulated_on("sim:", job) == open_simulated("sim:")
    assert open_receiver(job).description == "simulated receiver on the sample field"


def test_a_field_without_a_way_is_said_before_the_start() -> None:
    ring = [(8.5, 47.5), (8.50001, 47.5), (8.50001, 47.50001), (8.5, 47.50001), (8.5, 47.5)]
    job = job_on(FieldDocument(name="Crumb", boundary=Geometry(coordinates=[ring])))
    with pytest.raises(SourceError, match="the simulated tractor finds no way on this field: the field of"):
        open_receiver(job)


def test_a_job_with_another_receiver_opens_that() -> None:
    receiver = sample_job().receiver.model_copy(update={"source": "udp://:9999", "attitude_source": "sim:"})
    source = open_receiver(sample_job().model_copy(update={"receiver": receiver}))
    assert "9999" in source.description


def test_it_stops_when_it_is_told() -> None:
    stop = threading.Event()
    events = open_simulated("sim:").events(stop)
    next(events)
    next(events)
    stop.set()
    assert list(events) == []


def test_a_source_opened_by_its_uri_keeps_time_by_itself() -> None:
    source = open_source("sim:?seed=3")
    assert source.live
    assert source.duration is None
    assert "simulated" in source.description


@pytest.mark.parametrize(
    ("uri", "sentence"),
    [
        ("sim:field", "come only options"),
        ("sim:?colour=red", "'colour' is no option of sim:; there are rate, decimals, seed, speed, sentences"),
        ("sim:?rate=3", "it is one of 1, 2, 5, 10, 25, 50 Hz"),
        ("sim:?rate=", "rate is ''"),
        ("sim:?rate=5&rate=5", "given twice"),
        ("sim:?decimals=1", "from 2 to 9"),
        ("sim:?decimals=4.5", "from 2 to 9"),
        ("sim:?seed=-1", "whole number from 0"),
        ("sim:?seed=99999999999", "whole number from 0"),
        ("sim:?speed=nan", "2 to 15 km/h"),
        ("sim:?speed=100", "2 to 15 km/h"),
        ("sim:?sentences=RMC", "GGA and any of"),
        ("sim:?sentences=GGA,XYZ", "GGA and any of"),
    ],
)
def test_an_impossible_option_is_refused_in_a_sentence(uri: str, sentence: str) -> None:
    with pytest.raises(SourceError, match=sentence):
        open_simulated(uri)
