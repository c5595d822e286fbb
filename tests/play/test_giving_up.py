"""A controller that cannot go on ends itself, and nothing else."""

import numpy as np
import pytest

from tpsim.errors import ArgumentError
from tpsim.play.session import Session


class GivesUp:
    """A controller that cannot go on after 50 ms."""

    def command(self, state, time):
        if time > 0.051:
            raise ArgumentError("no frame says how the joint moves")
        return np.zeros(state.robot.n)


def test_a_controller_that_gives_up_ends_neither_time_nor_a_recording(study, models):
    session = Session(study, models)
    session.record()
    session.going.controller = GivesUp()
    assert session.advance(200) == 26
    assert session.message == "The arms hold still: no frame says how the joint moves"
    assert session.ended.condition.duration == pytest.approx(0.052)
    q = session.going.state.q
    assert session.advance(400) == 400
    np.testing.assert_allclose(session.going.state.q, q, atol=0.02)
    assert np.abs(session.going.state.dq).max() < 0.01


def test_another_controller_beside_may_give_up_alone(study, models):
    session = Session(study, models)
    session.compare("still")
    session.beside.controller = GivesUp()
    assert session.advance(200) == 200
    assert session.beside is None
    assert session.message == "'still' ended: no frame says how the joint moves"
