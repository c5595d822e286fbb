"""The low-pass filter: its gain at known frequencies, no delay, what it leaves alone."""

import numpy as np
import pytest

from tpsim import low_pass
from tpsim.errors import ArgumentError

T = np.arange(0, 10, 0.01)


@pytest.mark.parametrize("frequency", [0.5, 1.0, 4.0, 8.0, 12.0])
def test_sines_keep_their_phase_and_have_the_stated_gain(frequency):
    wave = np.sin(2 * np.pi * frequency * T)
    middle = slice(300, -300)
    # The bilinear transform warps frequencies near half of the rate.
    warped = np.tan(np.pi * frequency * 0.01) / np.tan(np.pi * 4 * 0.01)
    gain = 1 / (1 + warped**4)
    np.testing.assert_allclose(low_pass(T, wave, 4.0)[middle], gain * wave[middle], atol=1e-6)
    if frequency >= 8:
        assert gain < 0.06
    if frequency <= 1:
        assert gain > 0.99


def test_straight_lines_and_rests_pass_to_the_ends_and_columns_apart():
    values = np.column_stack([0.3 * T - 1, np.full_like(T, 2.0)])
    np.testing.assert_allclose(low_pass(T, values, 4.0), values, atol=1e-6)
    np.testing.assert_allclose(low_pass(T[:2], values[:2], 4.0), values[:2], atol=1e-2)


@pytest.mark.parametrize(
    ("time", "cutoff", "words"),
    [
        (T**2 + T, 4.0, "unevenly"),
        (T, 50.0, "below 50"),
        (T, 0.0, "above"),
        (T[:-1], 4.0, "as many of each|pairs"),
    ],
)
def test_what_cannot_be_filtered_is_refused(time, cutoff, words):
    with pytest.raises(ArgumentError, match=words):
        low_pass(time, np.zeros(len(T)), cutoff)
