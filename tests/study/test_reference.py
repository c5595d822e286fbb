import textwrap

import pytest

from tpsim.errors import ArgumentError
from tpsim.study.reference import is_ours, load_study
from tpsim.study.study import Study

HEAD = """
from tests_toy import Bring
from tpsim.study.study import Study

"""


@pytest.fixture
def user(tmp_path, monkeypatch, toy):
    """Writes a user's file, which can use the toy's task."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(__import__("sys").modules, "tests_toy", __import__("sys").modules["toy"])

    def write(body, name="mine.py"):
        file = tmp_path / name
        file.write_text(HEAD + textwrap.dedent(body))
        return file

    return write


def test_studies_tasks_and_functions_are_found_in_files(user):
    file = user(
        """
        study = Study(Bring(), title="mine")
        task = Bring(effort=0.2)
        Kind = Bring
        def make():
            return Study(Bring(effort=0.3))
        """
    )
    assert load_study(f"{file}:study").title == "mine"
    assert load_study(str(file)).reference == f"{file}:study"
    assert load_study(f"{file}:task").task.effort == 0.2
    assert load_study(f"{file}:make").task.effort == 0.3
    assert isinstance(load_study(f"{file}:Kind"), Study)
    assert load_study(f"{file}:make").reference == f"{file}:make"


def test_modules_and_short_names_are_found(user):
    user("study = Study(Bring(), title='m')", "my_module.py")
    assert load_study("my_module:study").reference == "my_module:study"
    assert load_study("short", {"short": "my_module:study"}).reference == "my_module:study"


@pytest.mark.parametrize(
    ("body", "name", "words"),
    [
        ("x = 1\ny = 1 / 0", "study", r"does not import \(mine.py, line 6\): ZeroDivisionError"),
        ("x = (", "study", r"does not import \(mine.py, line 5\): SyntaxError"),
        ("import no_such_thing", "study", r"mine.py, line 5\): ModuleNotFoundError"),
        ("raise SystemExit(3)", "study", r"line 5\): SystemExit: 3"),
        (
            "Study(Bring(), 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14)",
            "study",
            r"line 5\): TypeError",
        ),
        ("a = Study(Bring())\nb = Bring()", "study", "has no 'study'; it has a, b"),
        ("studio = 3", "study", "it has no study at all: write study = "),
        ("study = 3", "study", "is of type int; name a Study, a Task"),
        ("def study(a): pass", "study", "cannot be called without arguments"),
        ("def study(): return 3", "study", "is of type int"),
    ],
)
def test_what_is_no_study_is_refused_in_one_line(user, body, name, words):
    with pytest.raises(ArgumentError, match=words) as error:
        load_study(f"{user(body)}:{name}")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("reference", "words"),
    [
        ("no_file.py:study", "there is no file no_file.py"),
        ("no_package.module:study", "does not import.*ModuleNotFoundError"),
        ("cup-and-suger", "no study 'cup-and-suger'; did you mean cup-and-sugar"),
        ("", "there is no study ''"),
        (":study", "there is no study ':study'"),
        ("a b:c", "there is no study 'a b:c'"),
    ],
)
def test_references_that_lead_nowhere(reference, words):
    with pytest.raises(ArgumentError, match=words):
        load_study(reference, {"cup-and-sugar": "x:y", "cup": "x:y"})


def test_only_studies_of_tpsim_are_its_own():
    assert is_ours("tpsim.tasks.cup_and_sugar.study:cup")
    for reference in ("tpsim.tasks:study", "tpsim.cli.main:main", "mine:study", "x.py:study", ""):
        assert not is_ours(reference)
    for reference in ("tpsim.tasks.a.study:__x", "tpsim.tasks.a\n.b:c", "tpsim.tasks.a:b\n"):
        assert not is_ours(reference)
