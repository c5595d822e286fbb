import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim.errors import RecordingError
from tpsim.study.condition import Condition, Lead
from tpsim.study.files.checked import from_json, plain, to_json
from tpsim.task.task import Situation
from tpsim.world.object_path import ObjectPath
from tpsim.world.people.push import Push
from tpsim.world.plant import Plant

names = st.sampled_from(["tip", "", "é\u2028"])
numbers = st.floats(-1e90, 1e90)
positive = st.floats(0, 1e90)
triples = st.tuples(numbers, numbers, numbers)
paths = st.builds(
    ObjectPath,
    names,
    st.tuples(triples),
    st.tuples(numbers),
    st.none() | st.just(((0.0, 1.0, 0.0, 0.0),)),
)
pushes = st.builds(Push, names, triples, positive, positive, triples)
leads = st.builds(Lead, names, triples, triples, max_force=positive | st.just(float("inf")))
plants = st.builds(
    Plant,
    mass=st.floats(0, 0.9),
    encoder_bits=st.none() | st.integers(4, 32),
    velocity_cutoff=st.floats(1, 100) | st.just(float("inf")),
)
situations = st.builds(
    Situation,
    st.lists(numbers, max_size=7).map(tuple),
    st.lists(paths, max_size=2).map(tuple),
    st.integers(0, 2**64),
)
conditions = st.builds(
    Condition,
    names,
    situations,
    push=st.lists(pushes, max_size=2).map(tuple),
    lead=st.lists(leads, max_size=2).map(tuple),
    plant=plants,
    duration=st.none() | st.floats(1e-9, 1e9),
    shown=st.none() | names,
)


@settings(max_examples=25, deadline=None)
@given(conditions)
def test_conditions_come_back_exactly(condition):
    text = to_json(condition)
    back = from_json(text, Condition, "file")
    assert back == condition
    assert repr(back) == repr(condition)
    assert to_json(back) == text


EXAMPLE = Condition(
    "pushed",
    Situation((0.1, 0.2), (ObjectPath.at("cup", (1, 2, 3)),)),
    push=(Push("tip", (1.0, 0.0, 0.0)),),
    lead=(Lead("tip", (0.0, 0.0, 0.0), (0.1, 0.0, 0.0)),),
)


def leaves(value, path=()):
    """Paths to everything in a JSON value, itself included."""
    yield path
    inner = value.items() if isinstance(value, dict) else ()
    inner = enumerate(value) if isinstance(value, list) else inner
    for key, item in inner:
        yield from leaves(item, (*path, key))


def at(value, path):
    for key in path:
        value = value[key]
    return value


PATHS = [path for path in leaves(plain(EXAMPLE)) if path]
WRONG = [{"no": "field"}, [[]], float("nan"), True]


def changed(path, change):
    """Text of the example, of which something was changed."""
    value = plain(EXAMPLE)
    change(at(value, path[:-1]), path[-1])
    return json.dumps(value)


@pytest.mark.parametrize("path", PATHS, ids=str)
@pytest.mark.parametrize("wrong", WRONG, ids=repr)
def test_a_wrong_type_is_refused_with_file_and_field(path, wrong):
    text = changed(path, lambda above, last: above.__setitem__(last, wrong))
    with pytest.raises(RecordingError, match=r"^run\.json") as error:
        from_json(text, Condition, "run.json")
    assert "\n" not in str(error.value)
    assert wrong != wrong or "`$" in str(error.value)


@pytest.mark.parametrize("path", [path for path in PATHS if isinstance(path[-1], str)], ids=str)
def test_missing_and_unknown_keys_are_named(path):
    with pytest.raises(RecordingError, match=rf"^run\.json: .*`{path[-1]}`"):
        from_json(changed(path, lambda above, last: above.pop(last)), Condition, "run.json")
    text = changed(path, lambda above, last: above.setdefault("surplus", 1))
    with pytest.raises(RecordingError, match=r"there is no field `surplus` - at `\$"):
        from_json(text, Condition, "run.json")


def test_settings_of_any_kind_become_plain():
    @dataclass
    class Setting:
        n: np.int64
        where: Path

    setting = {"a": Setting(np.int64(3), Path("x") / "y"), "b": np.eye(2), "c": (None, True)}
    assert plain(setting) == {
        "a": {"n": 3, "where": "x/y"},
        "b": [[1, 0], [0, 1]],
        "c": [None, True],
    }
    for wrong in (object(), float("nan"), lambda: 0, 1j):
        with pytest.raises(RecordingError, match="cannot be written as JSON"):
            plain({"a": wrong})
