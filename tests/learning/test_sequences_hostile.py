"""Hostile sequences end in a TpsimError or in a finite model, never in NaN or a warning."""

import warnings

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim.errors import TpsimError
from tpsim.learning.dtw import dtw
from tpsim.learning.hmm import fit_hmm
from tpsim.learning.hsmm import fit_hsmm
from tpsim.learning.pgmm import fit_pgmm
from tpsim.learning.selection import dp_means_start

VALUES = st.sampled_from(
    [0.0, 1.0, -1.0, 0.5, 2.0, 1e-12, 1e-300, 1e8, -1e8, 1e60, 1e150, np.nan, np.inf]
)
TAME = st.sampled_from([0.0, 1.0, -1.0, 0.5, 2.0, 1e-9, 1e6])


@st.composite
def sequences(draw):
    """A few short sequences of few different values, so that points repeat."""
    values = draw(st.sampled_from([VALUES, TAME, TAME, TAME]))
    D = draw(st.integers(1, 3))
    lengths = draw(st.lists(st.integers(0, 8), min_size=1, max_size=3))
    return [
        np.array(draw(st.lists(values, min_size=T * D, max_size=T * D))).reshape(T, D)
        for T in lengths
    ]


def finite(model):
    chain_and_emissions = [model.chain.initial, model.chain.transitions, model.history]
    gaussians = model.gaussians
    return all(
        np.isfinite(x).all() for x in (*chain_and_emissions, gaussians.mean, gaussians.covariance)
    )


@settings(max_examples=150, deadline=None)
@given(sequences(), st.integers(1, 4), st.sampled_from(["left-right", "any"]), st.booleans())
def test_hidden_states(data, K, topology, explicit_durations):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            fit = fit_hsmm if explicit_durations else fit_hmm
            model = fit(data, K, topology=topology, max_iterations=10)
        except TpsimError:
            return
        assert finite(model)
        longest = max(data, key=len)
        np.testing.assert_allclose(model.responsibilities(longest).sum(1), 1.0)
        np.testing.assert_allclose(model.forward(longest).sum(1), 1.0)
        np.testing.assert_allclose(model.state_probabilities(9).sum(1), 1.0)
        assert set(model.viterbi(longest)) <= set(range(K))


@settings(max_examples=150, deadline=None)
@given(sequences(), st.integers(1, 4), st.integers(0, 3), st.data())
def test_parametric_mixture(data, K, q, draw):
    Q = draw.draw(
        st.lists(st.lists(VALUES, min_size=q, max_size=q), min_size=len(data), max_size=len(data))
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            model = fit_pgmm(data, Q, K, max_iterations=10)
        except TpsimError:
            return
        for value in (model.priors, model.maps, model.covariance, model.history):
            assert np.isfinite(value).all()


@settings(max_examples=150, deadline=None)
@given(sequences())
def test_warp_and_clusters(data):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            warp = dtw(data[0], data[-1])
            assert np.isfinite(warp.cost)
            start = dp_means_start(data[0], 0.5)
        except TpsimError:
            return
        assert np.isfinite(start.gaussians.mean).all()
