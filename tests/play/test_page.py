"""What goes wrong is said in the page, nothing is lost, and physics goes on; without a browser."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("viser", reason="viser is not installed: pip install 'tpsim[play]'")

ME, YOU = 71, 72


@pytest.fixture
def said(page, monkeypatch):
    """What the page told people since the test began."""
    words = []
    monkeypatch.setattr(page, "tell", lambda title, text, *a, **k: words.append(text))
    return words


def click(page, work):
    page.guarded(work)(None)


def drag(page, who, phase, wanted=None):
    """Drag the tip of the arm with the mouse of one browser."""
    model = page.session.world.model
    here = page.session.going.episode.simulation.data.site("tip").xpos.copy()
    wanted = here if wanted is None else wanted
    page._grabbed(who, model.body("lower").id, phase, here, np.asarray(wanted))
    return here


def show(page, wait_for, seconds):
    """A demonstration of so long, up to its verdict."""
    click(page, page._teaching._toggle)
    here = drag(page, ME, "start")
    drag(page, ME, "update", here + np.array([-0.03, 0.06, 0.0]))
    wait_for(lambda: page.session.recording and page.session.time > seconds, "the demonstration")
    drag(page, ME, "end")
    click(page, page._teaching._toggle)


def passes(page, wait_for):
    """Whether time still passes."""
    before = page.session.going.steps
    wait_for(lambda: page.session.going.steps != before, "time to pass")
    assert page.clock.failure is None


def test_a_demonstration_of_a_tenth_of_a_second_is_refused(page, said, wait_for):
    show(page, wait_for, 0.1)
    assert "shows nothing: hold on for 0.5 s at least" in said[0]
    assert page._teaching._pending is None
    passes(page, wait_for)


def test_a_folder_that_is_not_writable_loses_no_demonstration(page, said, wait_for, tmp_path):
    show(page, wait_for, 0.6)
    good, page.shelf.folder = page.shelf.folder, tmp_path / "file" / "kept"
    (tmp_path / "file").write_text("")
    try:
        click(page, page._teaching._keep_it)
        assert "file" in said[-1]
        assert page.lessons.shown["bring"] == []
    finally:
        page.shelf.folder = good
    count = len(said)
    click(page, page._teaching._keep_it)
    assert len(said) == count
    assert len(page.lessons.shown["bring"]) == 1
    assert (good / "demonstrations" / "bring" / "trial-000000.npz").is_file()


def test_one_demonstration_is_too_few_to_learn_from(page, said, wait_for):
    before = page.session.models
    click(page, page._learning._learn)
    assert "'bring' was shown 1 times; show it 2 times at least" in said[-1]
    assert page.session.models is before
    assert page._learning._button.disabled
    assert page._learning._missing.content == "Before it can learn, show it **bring** once more."
    passes(page, wait_for)


def test_what_a_closed_browser_held_is_let_go(page, said, wait_for):
    session = page.session
    with session.lock:
        session.perform()
    here = drag(page, ME, "start")
    drag(page, ME, "update", here + np.array([0.0, 0.1, 0.0]))
    with session.lock:
        session.grab(("mouse", ME), "mark", here)
    page._teaching._led["tip"] = ME
    page._gone(SimpleNamespace(client_id=ME))
    with session.lock:
        assert not session.pulls
        assert not session.led.takers
    assert page._teaching._led == {}
    passes(page, wait_for)


def test_two_people_at_one_body_are_told_that_their_forces_add(page, said, wait_for):
    for who in (ME, YOU):
        drag(page, who, "start")
    assert len(page.session.pulls) == 2
    wait_for(lambda: any("their forces add" in words for words in said), "words about it")
    for who in (ME, YOU):
        drag(page, who, "end")
    assert not page.session.pulls
