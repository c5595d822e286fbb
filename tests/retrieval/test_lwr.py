import numpy as np
import pytest

from tpsim import lwr
from tpsim.errors import ArgumentError


def test_a_line_is_found_exactly():
    t = np.linspace(0, 1, 30)
    y = np.c_[1 + 2 * t, -t]
    path = lwr(t, y, [0.1, 0.55], 0.1, ridge=1e-6)
    np.testing.assert_allclose(path.mean, [[1.2, -0.1], [2.1, -0.55]])
    np.testing.assert_allclose(path.covariance, np.tile(1e-6 * np.eye(2), (2, 1, 1)), atol=1e-12)


def test_degree_zero_is_a_weighted_average():
    rng = np.random.default_rng(0)
    t, y = rng.uniform(size=20), rng.normal(size=(20, 2))
    h = np.exp(-0.5 * ((t - 0.4) / 0.2) ** 2)
    h /= h.sum()
    path = lwr(t, y, 0.4, 0.2, degree=0, ridge=0.0)
    np.testing.assert_allclose(path.mean[0], h @ y)
    np.testing.assert_allclose(path.covariance[0], np.cov(y.T, aweights=h, ddof=0))


def test_each_query_is_weighted_least_squares():
    rng = np.random.default_rng(1)
    t, y = np.sort(rng.uniform(size=40)), rng.normal(size=(40, 1))
    root = np.exp(-0.25 * ((t - 0.3) / 0.15) ** 2)
    powers = np.vander(t - 0.3, 3, increasing=True)
    fit = np.linalg.lstsq(powers * root[:, None], y * root[:, None])[0]
    np.testing.assert_allclose(lwr(t, y, [0.3], 0.15, degree=2).mean[0], fit[0], rtol=1e-8)


def test_covariance_is_that_of_the_demonstrations():
    """Four lines side by side: the spread across them, none along."""
    t = np.tile(np.linspace(0, 1, 50), 4)
    offset = np.repeat([-1.0, 0, 0, 1.0], 50)
    path = lwr(t, np.c_[t, t + offset], [0.5], 0.05, ridge=0.0)
    np.testing.assert_allclose(path.covariance[0], [[0, 0], [0, 0.5]], atol=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (dict(queries=[5.0]), "from every input"),
        (dict(width=0.0), "width"),
        (dict(degree=-1), "degree"),
        (dict(width=1e-3, degree=2), "Too few inputs"),
        (dict(inputs=[0.0]), "must be"),
        (dict(outputs=np.full((3, 1), np.nan)), "NaN"),
    ],
)
def test_bad_arguments(change, message):
    arguments = dict(inputs=[0.0, 0.5, 1.0], outputs=np.zeros((3, 1)), queries=[0.5], width=0.5)
    with pytest.raises(ArgumentError, match=message):
        lwr(**arguments | change)
