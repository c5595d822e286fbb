"""What people do in a session while time passes, without any browser."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim.errors import ArgumentError
from tpsim.play.lessons import Lessons
from tpsim.play.objects import LedObjects
from tpsim.play.session import HOLD, Session
from tpsim.study.executor import perform_condition
from tpsim.task.task import draw_situation
from tpsim.world.object_path import MovingObjects
from tpsim.world.people.drag import PULL, Drag
from tpsim.world.people.guide import Grip
from tpsim.world.teaching import demonstrate


def same_bits(one, other):
    assert one.channels == other.channels
    assert one.arrays.keys() == other.arrays.keys()
    different = [n for n in one.arrays if one[n].tobytes() != other[n].tobytes()]
    assert different == []


def tip(session):
    return session.going.episode.simulation.data.site("tip").xpos.copy()


def off(session, x, y):
    """The tip, and this far from it."""
    return tip(session) + np.array([x, y, 0.0])


def lead(session, travel, steps=300, who="me", body="lower"):
    """Take the tip, lead it by ``travel``, and let go."""
    here = tip(session)
    session.grab(who, body, here)
    for part in np.linspace(0, 1, 20):
        session.advance(steps // 20)
        session.move(who, here + part * np.array(travel))
    session.advance(50)
    session.let_go(who)


@pytest.fixture
def session(study, models):
    return Session(study, models)


def test_a_hand_is_a_spring_with_limited_strength(study, models):
    """Held far away it pulls with all its strength, nearby in proportion to the distance."""
    for far, force in ((1.0, PULL.max_force), (0.01, None)):
        session = Session(study, models)
        session.perform("still")
        here = tip(session)
        session.grab("me", "lower", here)
        session.move("me", here + np.array([0, far, 0]))
        session.advance(1000)
        drag = session.pulls["me"].drag
        pulled = np.linalg.norm(drag.wrench[:3])
        wanted = force or PULL.stiffness * np.linalg.norm(here + np.array([0, far, 0]) - drag.point)
        np.testing.assert_allclose(pulled, wanted, rtol=1e-3)


def test_the_hand_moves_within_thirty_milliseconds(session):
    """Of a drag by 10 cm, a millimetre: browsers send what the mouse does every 50 ms."""
    session.teach()
    here = tip(session)
    session.grab("me", "lower", here)
    session.advance(10)
    session.move("me", here + np.array([0.0, 0.1, 0.0]))
    session.advance(round(0.03 / session.world.timestep))
    assert np.linalg.norm(tip(session) - here) > 1e-3


def test_the_drag_stops_where_it_is_let_go(session):
    session.grab("me", "lower", tip(session))
    session.move("me", [0, 0, 0])
    session.advance(20)
    assert np.linalg.norm(session.pulls["me"].drag.wrench) > 1
    session.let_go("me")
    session.advance(1)
    assert not session.going.episode.simulation.data.xfrc_applied.any()
    assert session.going.episode.people == []


def test_two_people_on_one_body_add_their_forces(session):
    here = tip(session)
    for who in ("me", "you"):
        session.grab(who, "lower", here)
        session.move(who, off(session, 0.0, 0.05))
    session.advance(10)
    mine, yours = (session.pulls[who].drag.wrench for who in ("me", "you"))
    np.testing.assert_array_equal(mine, yours)
    applied = session.going.episode.simulation.data.body("lower").xfrc_applied
    np.testing.assert_allclose(applied[:3], 2 * mine[:3])


def test_a_performance_repeats_bit_for_bit_by_its_values(session):
    session.record()
    session.advance(37)
    lead(session, [0.0, 0.1, 0.0])
    session.grab("object", "mark", tip(session))
    session.move("object", off(session, 0.02, -0.1))
    session.advance(33)
    session.move("object", off(session, -0.05, -0.1), (0.8, 0.0, 0.0, 0.6))
    session.advance(111)
    session.grab("me", "upper", [0.1, 0.1, 0.0])
    session.grab("you", "lower", tip(session))
    session.move("you", [0.2, 0.0, 0.0])
    session.advance(64)
    recorded = session.stop()
    again = perform_condition(session.study, session.models, recorded.condition)
    same_bits(recorded.trial, again)
    assert np.linalg.norm(recorded.trial["push_wrench"], axis=1).max() > 5
    assert np.ptp(recorded.trial["mark_position"], axis=0).max() > 0.05


def test_a_demonstration_by_hand_repeats_bit_for_bit(session, study):
    session.teach()
    session.start_demonstration("bring")
    session.advance(100)
    assert not session.recording, "recording waits for the hand"
    before = tip(session)
    lead(session, [-0.05, 0.08, 0.0], 600)
    recorded = session.stop()
    led = recorded.trial["hand_position"][-1] - before
    np.testing.assert_allclose(led, [-0.05, 0.08, 0.0], atol=0.01)
    assert recorded.trial.time[0] == 0.0
    again = demonstrate(study.task.stage, recorded.condition.lesson, study.task.sites())
    same_bits(recorded.trial, again)


def test_weightless_arms_stay_where_they_are_put(session):
    session.teach()
    session.advance(10)
    q = session.going.state.q.copy()
    session.advance(500)
    np.testing.assert_allclose(session.going.state.q, q, atol=1e-6)


def test_led_objects_are_where_their_paths_say(study):
    """What is led live is the same, bit for bit, as the path that is kept of it."""
    world = study.task.stage
    situation = draw_situation(study.task, 0, 0)
    simulation = world.simulation()
    simulation.reset(np.array(situation.start))
    led, seen = LedObjects(situation.objects, simulation), []
    for step in range(900):
        if step in (150, 163, 700):
            here = led.now.positions[0]
            there = here + np.array([0.1, 0.01 * (step % 7), 0.0])
            led.want("mark", there, (1.0, 0.0, 0.001 * step, 0.0))
        led.act(step)
        twist = np.zeros((1, 6)) if led.now.twists is None else led.now.twists
        seen.append((led.now.positions, led.now.quaternions, twist))
    script = MovingObjects(led.paths(), simulation)
    for step, (positions, quaternions, twists) in enumerate(seen):
        script.act(step)
        np.testing.assert_array_equal(script.now.positions, positions)
        np.testing.assert_array_equal(script.now.quaternions, quaternions)
        np.testing.assert_array_equal(script.now.twists, twists)
    assert len(led.paths()[0].times) < 300, "it is not kept where it rests"


def test_a_following_hand_keeps_its_place_beside_the_other():
    """Its wanted pose moves with the other hand: twist is the derivative of the pose."""
    from tpsim.catalogue.ours import planar5
    from tpsim.world.world import World

    world = World.compose(planar5())
    simulation = world.simulation()
    drag = Drag(
        "other", "right_hand", (0.0,), ((0.3, 0.0, 0.0),), ((1.0, 0.0, 0.0, 0.0),),
        relative_to="left_hand", grip=Grip(0.0, 1.0, 0.0, 1.0),
    )  # fmt: skip
    simulation.reset(world.robot.home)
    simulation.data.qvel[:] = 0.1 * np.arange(1, 1 + len(simulation.data.qvel))
    import mujoco

    mujoco.mj_forward(simulation.model, simulation.data)
    bound = drag.bind(simulation)
    wanted, twist = bound._follow(0)
    step = 1e-6
    simulation.data.qpos[:] += step * simulation.data.qvel
    mujoco.mj_forward(simulation.model, simulation.data)
    later, _ = bound._follow(0)
    np.testing.assert_allclose((later.position - wanted.position) / step, twist[:3], atol=1e-5)
    turned = (later.rotation @ wanted.rotation.T - np.eye(3)) / step
    spin = [turned[2, 1], turned[0, 2], turned[1, 0]]
    np.testing.assert_allclose(spin, twist[3:], atol=1e-5)


def test_the_ghost_meets_the_same_force(session):
    session.compare("still")
    here = tip(session)
    session.grab("me", "lower", here)
    session.move("me", off(session, 0.0, 0.1))
    session.advance(50)
    mine = session.going.episode.simulation.data.body("lower").xfrc_applied
    ghost = session.beside.episode.simulation.data.body("lower").xfrc_applied
    np.testing.assert_array_equal(mine[:3], ghost[:3])
    session.let_go("me")
    session.advance(2)
    assert not session.beside.episode.simulation.data.xfrc_applied.any()


def test_effort_changes_while_it_performs_but_not_while_it_is_recorded(session):
    session.advance(50)
    stiff = np.linalg.norm(session.going.command.stiffness)
    session.set_fields(effort=100 * session.task.effort)
    session.advance(50)
    assert np.linalg.norm(session.going.command.stiffness) < 0.2 * stiff
    session.record()
    with pytest.raises(ArgumentError, match="stop the recording"):
        session.set_fields(effort=1.0)


def test_without_models_it_holds_and_cannot_be_recorded(study):
    session = Session(study)
    assert session.controller == HOLD
    q = session.going.state.q.copy()
    session.advance(200)
    np.testing.assert_allclose(session.going.state.q, q, atol=1e-3)
    with pytest.raises(ArgumentError, match="nothing was learned"):
        session.record()


class Wild:
    def command(self, state, time):
        return np.full(state.robot.n, 1e6 if time > 0.1 else 0.0)


def test_a_robot_that_diverges_starts_anew(study, models):
    wild = replace(study, controllers={"wild": lambda *given: Wild()})
    session = Session(wild, models)
    session.going.controller = Wild()
    while not session.message:
        session.advance(500)
    assert "starts anew" in session.message
    assert session.time < 0.1


def test_what_cannot_be_done_is_said(session, study, taught):
    with pytest.raises(ArgumentError, match="nothing is being recorded"):
        session.stop()
    session.start_demonstration("bring")
    with pytest.raises(ArgumentError, match="nothing was shown yet"):
        session.stop()
    with pytest.raises(ArgumentError, match="no behaviour 'x'"):
        session.start_demonstration("x")
    with pytest.raises(ArgumentError, match="no controller 'x'"):
        session.perform("x")
    session.let_go("nobody")
    session.move("nobody", [0, 0, 0])


def test_a_short_demonstration_shows_nothing(session, study):
    session.start_demonstration("bring")
    session.grab("me", "lower", tip(session))
    session.advance(50)
    lessons = Lessons(study)
    with pytest.raises(ArgumentError, match=r"0\.1 s and shows nothing"):
        lessons.judge(session.task, session.stop())
    assert lessons.shown == {"bring": []}


def test_a_recording_that_is_too_long_ends_by_itself_and_is_not_lost(session, monkeypatch):
    from tpsim.play import session as sessions

    monkeypatch.setattr(sessions, "LONGEST", 0.3)
    session.record()
    while session.ended is None:
        session.advance(40)
    assert not session.recording
    assert session.ended.condition.duration == pytest.approx(0.3)
    assert session.ended.trial.time[-1] == pytest.approx(0.29)


def test_a_demonstration_ends_where_the_last_hand_lets_go(session, study):
    session.teach()
    session.start_demonstration("bring")
    lead(session, (-0.05, 0.06, 0.0))
    session.advance(400)  # before somebody presses the button
    shown = session.stop()
    seconds = shown.condition.duration
    assert shown.condition.drag[0].until == pytest.approx(seconds)
    assert shown.trial.time[-1] < seconds < session.time - 0.5
    same_bits(demonstrate(session.world, shown.condition.lesson, study.task.sites()), shown.trial)
