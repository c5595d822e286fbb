"""Results of another method are never taken for those of this one."""

import subprocess
import sys
from functools import partial

import numpy as np
import pytest

from tpsim.learning.subspace import HDDC, MFA
from tpsim.section8 import METHODS
from tpsim.section8.fingerprint import fingerprint
from tpsim.section8.in_frames import tp_gmr_with
from tpsim.section8.methods import method_from


def counted(n, start=0, *, by=1):
    return n + start * by


def closing_over(value):
    return lambda demonstrations: value


class Called:
    def __init__(self, gain):
        self.gain = gain

    def __call__(self, demonstrations):
        return self.gain

    def learn(self, demonstrations):
        return self.gain


def test_all_built_in_methods_differ():
    assert len({fingerprint(method) for method in METHODS.values()}) == len(METHODS)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (tp_gmr_with(MFA(1)), tp_gmr_with(MFA(2))),
        (tp_gmr_with(MFA(1)), tp_gmr_with(HDDC(1))),
        (tp_gmr_with("full", "held"), tp_gmr_with("full", "product")),
        (partial(counted, start=1), partial(counted, start=2)),
        (closing_over(np.arange(3)), closing_over(np.array([0, 1, 3]))),
        (closing_over({"a": [1]}), closing_over({"a": [2]})),
        (closing_over(closing_over(1)), closing_over(closing_over(2))),
        (Called(1.0), Called(2.0)),
        (Called(1.0).learn, Called(2.0).learn),
        ({"a": counted}, {"b": counted}),
    ],
)
def test_what_is_bound_counts(one, other):
    assert fingerprint(one) != fingerprint(other)


def test_the_same_is_the_same():
    assert fingerprint(tp_gmr_with(MFA(2))) == fingerprint(tp_gmr_with(MFA(2)))
    assert fingerprint(Called(1.0)) == fingerprint(Called(1.0))


def test_a_function_that_closes_over_itself_ends():
    def again(n):
        return again(n - 1) if n else 0

    assert fingerprint(again) == fingerprint(again)


def test_another_process_finds_the_same():
    """A comparison that was cut off goes on in another process."""
    words = (
        "from tpsim.section8 import METHODS; from tpsim.section8.fingerprint import fingerprint; "
        "print(fingerprint(METHODS))"
    )
    done = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == fingerprint(METHODS)


def test_a_helper_in_the_users_file_counts(tmp_path):
    text = "def helper():\n    return {}\n\ndef f(taught):\n    return helper()\n"
    found = []
    for gain in (1, 2):
        path = tmp_path / f"{gain}" / "mine.py"
        path.parent.mkdir()
        path.write_text(text.format(gain))
        found.append(fingerprint(method_from(f"{path}:f")))
    assert found[0] != found[1]
