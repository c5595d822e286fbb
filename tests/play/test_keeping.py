"""What is learned in a session and kept of it, the clock, and who may connect."""

import os
import socket

import numpy as np
import pytest

from tpsim.errors import ArgumentError, RecordingError
from tpsim.play import clock
from tpsim.play.clock import Pace, RealTime
from tpsim.play.lessons import Lessons
from tpsim.play.session import Session
from tpsim.play.shelf import Shelf
from tpsim.study.files.run import load_run
from tpsim.study.replay import replay
from tpsim.study.teaching_files import read_demonstrations
from tpsim.task.verbs import learn


def show(session, travel):
    session.start_demonstration("bring")
    data = session.going.episode.simulation.data
    here = data.site("tip").xpos.copy()
    session.grab("me", "lower", here)
    for part in np.linspace(0, 1, 10):
        session.advance(40)
        session.move("me", here + part * np.array(travel))
    session.let_go("me")
    return session.stop()


@pytest.fixture(scope="module")
def shown(study, models):
    """A session in which two demonstrations were shown, and what they were."""
    session = Session(study, models)
    found = []
    for k in range(2):
        session.reset()
        session.teach()
        found.append(show(session, [-0.05, 0.05 + 0.02 * k, 0.0]))
    return session, found


def test_one_learns_from_what_was_shown_before_what_was_given(study, taught, shown):
    session, found = shown
    lessons = Lessons(study, {"bring": taught["bring"]})
    assert lessons.learn(study.task).by_hand == ()
    lessons.keep(found[0])
    with pytest.raises(ArgumentError, match="'bring' was shown 1 times"):
        lessons.learn(study.task)
    lessons.keep(lessons.judge(session.task, found[1]))
    learned = lessons.learn(study.task)
    assert learned.by_hand == ("bring",)
    assert learned.counts == {"bring": 2}
    same = learn(study.task, {"bring": [recorded.trial for recorded in found]})["bring"]
    for one, other in zip(learned.models["bring"].frames, same.frames, strict=True):
        np.testing.assert_array_equal(one.mean, other.mean)
        np.testing.assert_array_equal(one.covariance, other.covariance)
    lessons.throw_away("bring")
    lessons.throw_away("bring")
    with pytest.raises(ArgumentError, match="no demonstration of 'bring'"):
        lessons.throw_away("bring")


def test_a_frame_that_is_off_brings_no_precision(study, taught):
    lessons = Lessons(study, taught)
    on = lessons.learn(study.task).models["bring"]
    off = lessons.learn(study.task, {"bring": ["mark"]}).models["bring"]
    assert on.precisions[0].any()
    assert not off.precisions[0].any()
    np.testing.assert_array_equal(off.precisions[1], on.precisions[1])
    with pytest.raises(ArgumentError, match="every frame is off"):
        lessons.learn(study.task, {"bring": ["mark", "posture"]})


def test_learning_apart_gives_the_same_bits(study, taught):
    here, apart = Lessons(study, taught), Lessons(study, taught, apart=True)
    try:
        one, other = (each.learn(study.task).models["bring"] for each in (here, apart))
    finally:
        apart.close()
    np.testing.assert_array_equal(one.frames[0].covariance, other.frames[0].covariance)


def test_what_is_kept_are_ordinary_recordings(study, models, shown, tmp_path):
    session, found = shown
    shelf = Shelf(study.task.name, tmp_path / "kept")
    for count in (1, 2):
        place = shelf.keep_demonstrations(study, "bring", found[:count])
        assert replay(load_run(place), study)["verdict"].startswith(f"all {count} trials")
    read = read_demonstrations(study.task, shelf.folder / "demonstrations")["bring"]
    np.testing.assert_array_equal(read[1]["q"], found[1].trial["q"])
    assert sorted(p.name for p in place.parent.iterdir()) == ["bring"], "nothing half-done stays"
    shelf.keep_demonstrations(study, "bring", [])
    assert not place.exists()

    session.record()
    session.grab("me", "lower", [0.3, 0.3, 0.0])
    session.advance(150)
    recorded = session.stop()
    for name in ("played", "played~2"):
        place = shelf.keep_performance(session.study, models, recorded)
        assert place.name == name
    assert replay(load_run(place), study)["repeats"]


@pytest.mark.skipif(os.geteuid() == 0, reason="everything is writable to the superuser")
def test_a_folder_that_is_read_only_keeps_nothing_and_says_so(study, shown, tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(RecordingError, match="Permission denied"):
        Shelf("toy", tmp_path / "kept").keep_demonstrations(study, "bring", shown[1])


def test_a_folder_that_cannot_be_made_keeps_nothing_and_says_so(study, shown, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordingError, match="file"):
        Shelf("toy", tmp_path / "file" / "kept").keep_demonstrations(study, "bring", shown[1])


def test_the_pace_is_real_time_and_catches_up():
    """Steps add up to the time that passed; a hiccup below the patience loses nothing."""
    pace, now, steps = Pace(0.001, 10.0), 10.0, 0
    for tick in range(400):
        now += 0.09 if tick == 200 else 0.004
        steps += pace.due(now, 1.0)
    assert abs(steps - 1000 * (now - 10.0)) <= 1
    assert pace.simulated == pytest.approx(pace.passed, abs=0.001)


def test_the_pace_forgives_what_cannot_be_caught_up():
    """Where a step takes longer than it lasts, every go stays short and time is slow."""
    pace, now, steps = Pace(0.001, 0.0), 0.0, 0
    for _ in range(400):
        due = pace.due(now, 1.0)
        assert due <= round(clock.BATCH / 0.001)
        steps, now = steps + due, now + 0.004 + 0.002 * due
    assert pace.factor == pytest.approx(steps * 0.001 / now, rel=0.05)
    assert 0.3 < pace.factor < 0.5
    assert pace.late <= clock.PATIENCE


@pytest.mark.parametrize("speed", [0.1, 0.0, 2.0])
def test_the_pace_follows_the_speed(speed):
    pace = Pace(0.001, 0.0)
    steps = sum(pace.due(0.004 * k, speed) for k in range(1, 501))
    assert abs(steps - 2000 * speed) <= 1


def test_the_thread_ends_and_leaves_none(study, models):
    import threading
    import time

    session = Session(study, models)
    thread = RealTime(session)
    thread.start()
    end = time.monotonic() + 10
    while session.time < 0.02 and time.monotonic() < end:
        time.sleep(0.01)
    thread.stop()
    assert session.time >= 0.02
    assert thread not in threading.enumerate()


def test_what_ends_the_simulation_is_kept(study, models):
    session = Session(study, models)
    session.advance = lambda steps: 1 / 0
    thread = RealTime(session)
    thread.start()
    thread.join(10)
    assert isinstance(thread.failure, ZeroDivisionError)


def test_who_may_connect():
    from tpsim.play.server import Address, allowed

    here, open_ = Address.of("127.0.0.1", 8080), Address.of("0.0.0.0", 8080)
    assert not here.token
    assert len(open_.token) >= 12
    mine = "http://127.0.0.1:8080", "127.0.0.1:8080"
    assert allowed(here, "/", *mine)
    assert not allowed(here, "/", "http://elsewhere.org", "127.0.0.1:8080")
    assert not allowed(open_, "/", None, "somewhere:8080")
    assert not allowed(open_, "/?token=wrong", None, "somewhere:8080")
    assert allowed(open_, f"/?token={open_.token}", None, "somewhere:8080")
    assert open_.token in open_.url(8080)
    assert here.url(8080) == "http://127.0.0.1:8080"


def test_a_port_in_use_is_named():
    pytest.importorskip("viser")
    from tpsim.play.server import Address, open_server

    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(ArgumentError, match=f"port {port} is in use.*--port {port + 1}"):
            open_server(Address.of("127.0.0.1", port), "toy")
    with pytest.raises(ArgumentError, match="--host"):
        open_server(Address.of("192.0.2.1", 0), "toy")
