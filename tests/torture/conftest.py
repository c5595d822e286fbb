"""Small originals of all that tpsim reads; commands as processes: started, disturbed, looked at."""

import json
import os
import random
import re
import select
import signal
import subprocess
import sys
import time
import uuid
from pathlib import Path
from types import SimpleNamespace

import pytest

from tpsim.deploy.policy import Policy
from tpsim.section8 import METHODS
from tpsim.section8.plan import Plan
from tpsim.section8.run import run as run_cells
from tpsim.study.condition import Condition
from tpsim.study.executor import perform_all
from tpsim.study.files.run import load_run, open_run
from tpsim.study.files.trial_file import load_trial
from tpsim.study.reference import load_study
from tpsim.study.teaching_files import write_demonstrations
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn, teach
from tpsim.world.people.push import Push

from ..test_archive import VALUES

TOY = f"{Path(__file__).parents[1] / 'study' / 'toy.py'}:study"
MARK = "TPSIM_TORTURE"
PROGRESS = re.compile(r"tpsim: (teaching|measuring|filming|reporting|\d+ trials)")
CODES = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129, "SIGKILL": -signal.SIGKILL}


FORKS = """
import json, os, signal, sys
import scipy.interpolate, scipy.signal
import tpsim.lab, tpsim.cli.parse, tpsim.data.commands, tpsim.study.teaching, tpsim.study.trying
import tpsim.campaign.run
from tpsim.cli.main import main
for line in sys.stdin:
    order = json.loads(line)
    process = os.fork()
    if not process:
        os.chdir(order["folder"])
        os.environ[order["name"]] = order["mark"]
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        for number, file in ((1, order["answer"]), (2, order["said"])):
            os.dup2(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        sys.argv = ["tpsim", *order["words"]]
        sys.exit(main())
    print(process, flush=True)
    print(os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), flush=True)
"""


class Forks:
    """A process that has imported everything and forks commands: they start in no time."""

    def __init__(self):
        line = [sys.executable, "-c", FORKS]
        self._server = subprocess.Popen(line, stdin=-1, stdout=-1, text=True, bufsize=1)

    def start(self, **order):
        """Fork a command; it answers as a Popen does."""
        self.returncode = None
        self._server.stdin.write(json.dumps(order) + "\n")
        self.pid = int(self._server.stdout.readline())
        return self

    def poll(self):
        """Exit code, None while it runs."""
        if self.returncode is None and select.select([self._server.stdout], [], [], 0)[0]:
            self.returncode = int(self._server.stdout.readline())
        return self.returncode

    def wait(self, seconds):
        """Exit code."""
        if self.returncode is not None:
            return self.returncode
        if select.select([self._server.stdout], [], [], seconds)[0]:
            return self.poll()
        raise TimeoutError(f"it runs after {seconds} s")

    def send_signal(self, number):
        """Signal the command."""
        os.kill(self.pid, number)

    def end(self):
        """End the process that forks."""
        self._server.stdin.close()
        self._server.wait(30)


class Command:
    """One command line in a process of its own; what it starts is known by its environment.

    Parameters
    ----------
    words : list of str
    folder : Path
        Current folder of the process.
    forks : Forks, optional
        Who starts it; by default Python starts afresh.
    """

    def __init__(self, words, folder, forks=None):
        self.mark = uuid.uuid4().hex
        self._said = folder / f".said-{self.mark}"
        if forks is not None:
            files = {"said": str(self._said), "answer": str(folder / ".answer")}
            about = {"words": words, "folder": str(folder), "name": MARK, "mark": self.mark}
            self.process = forks.start(**about, **files)
            return
        # Shells start what runs in the background deaf to SIGINT.
        deaf = signal.signal(signal.SIGINT, signal.default_int_handler)
        with self._said.open("wb") as said, (folder / ".answer").open("wb") as answer:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "tpsim", *words],
                cwd=folder,
                env={**os.environ, MARK: self.mark},
                stdin=subprocess.DEVNULL,
                stdout=answer,
                stderr=said,
            )
        signal.signal(signal.SIGINT, deaf)

    def wait(self):
        """Exit code."""
        return self.process.wait(300)

    @property
    def lines(self):
        """What it said on standard error, without its progress."""
        text = self._said.read_text(errors="replace")
        return [line for line in text.splitlines() if not PROGRESS.match(line)]

    def processes(self):
        """Processes that carry the mark, besides the driver."""
        found = []
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit() and int(entry.name) != self.process.pid:
                try:
                    if f"{MARK}={self.mark}".encode() in (entry / "environ").read_bytes():
                        found.append(int(entry.name))
                except OSError:
                    continue
        return found

    def orphans(self, seconds=5.0):
        """Processes that are there so long after the driver is gone."""
        end = time.monotonic() + seconds
        while (found := self.processes()) and time.monotonic() < end:
            time.sleep(0.05)
        return found


def workers(command):
    """Workers of a command, without the process that looks after loky's semaphores."""
    found = []
    for pid in command.processes():
        try:
            line = Path(f"/proc/{pid}/cmdline").read_bytes()
        except OSError:
            continue
        if b"popen_loky" in line:
            found.append(pid)
    return found


def disturb(command, how, after, rng):
    """Send signals to a command after some seconds; return whether they reached it."""
    end = time.monotonic() + after
    while time.monotonic() < end and command.process.poll() is None:
        time.sleep(0.005)
    if how == "worker":
        while command.process.poll() is None:
            if found := workers(command):
                time.sleep(rng.uniform(0, 0.8))
                try:
                    os.kill(rng.choice(found), signal.SIGKILL)
                except ProcessLookupError:
                    return False
                return True
            time.sleep(0.02)
        return False
    if command.process.poll() is not None:
        return False
    name, *again = how.split()
    command.process.send_signal(getattr(signal, name))
    for _ in again:
        time.sleep(rng.uniform(0.0, 0.3))
        if command.process.poll() is None:
            command.process.send_signal(getattr(signal, name))
    return True


def contents(folder):
    """Bytes of all recordings and models under a folder, by name; each is read, so it is whole."""
    found = {}
    for file in sorted(folder.rglob("*")) if folder.exists() else []:
        hidden = any(part.startswith(".") for part in file.relative_to(folder).parts)
        if hidden or not file.is_file():
            continue
        if file.name.startswith("trial-"):
            load_trial(file)
        elif file.name == "run.json":
            load_run(file.parent)
        if file.suffix in (".npz", ".csv", ".parquet"):
            found[str(file.relative_to(folder))] = file.read_bytes()
    return found


@pytest.fixture(scope="session")
def taught(tmp_path_factory):
    """Demonstrations of the toy."""
    folder = tmp_path_factory.mktemp("taught")
    command = Command(["teach", TOY, "--folder", "demonstrations"], folder)
    assert command.wait() == 0, command.lines
    return folder / "demonstrations"


@pytest.fixture(scope="session")
def forks():
    """Starts commands in no time."""
    forks = Forks()
    yield forks
    forks.end()


@pytest.fixture
def rng():
    """Random numbers, the same every time unless TPSIM_SEED says otherwise."""
    return random.Random(int(os.environ.get("TPSIM_SEED", "0")))


@pytest.fixture
def torture():
    """The helpers of this file."""
    return sys.modules[__name__]


@pytest.fixture(scope="session")
def toy():
    """The toy study, and what was taught and learned of it."""
    study = load_study(TOY)
    taught = teach(study.task, 2)
    return SimpleNamespace(study=study, taught=taught, models=learn(study.task, taught))


@pytest.fixture(scope="session")
def a_run(toy, tmp_path_factory):
    """A whole run of three trials, each of another kind, with its demonstrations."""
    return _run(toy, tmp_path_factory.mktemp("run") / "run", 0)


@pytest.fixture(scope="session")
def another_run(toy, tmp_path_factory):
    """The same of another seed."""
    return _run(toy, tmp_path_factory.mktemp("other") / "run", 1)


def _run(toy, folder, seed):
    situation = draw_situation(toy.study.task, seed, 0)
    push = Push("tip", (1.0, 2.0, 0.0), 0.02, 0.05)
    conditions = [
        Condition("unpushed", situation, duration=0.1),
        Condition("pushed", situation, "still", push=(push,), duration=0.1),
        Condition("taught", situation, shown="bring"),
    ]
    run = open_run(folder, study=toy.study, command="toy", configuration={"n": 3}, seed=seed)
    where = folder / "demonstrations" / "bring"
    shown = [trial.with_about(seed=seed) for trial in toy.taught["bring"]]
    write_demonstrations(where, toy.study, "bring", shown, seed=seed, command="toy")
    run.save_models(toy.models)
    for index, trial in enumerate(perform_all(toy.study, toy.models, conditions)):
        run.save(index, trial)
    run.finish()
    (folder / "report.html").write_text("what is drawn is no part of the record")
    return folder


@pytest.fixture(scope="session")
def models(tmp_path_factory):
    """A folder with a file of every kind of value and model."""
    folder = tmp_path_factory.mktemp("models") / "models"
    for kind, make in VALUES.items():
        make().save(folder / f"{kind}.npz")
    return folder


@pytest.fixture(scope="session")
def policy(toy, tmp_path_factory):
    """Folder of a policy."""
    folder = tmp_path_factory.mktemp("policies") / "policy"
    return Policy(toy.study.task, toy.models).save(folder)


@pytest.fixture(scope="session")
def cells(tmp_path_factory):
    """Folder of a small comparison, its plan and its methods."""
    plan = Plan(("transfer",), (2,), (0, 1), (1.0,), situations=2, samples=20)
    methods = {"TP-LWR": METHODS["TP-LWR"]}
    folder = tmp_path_factory.mktemp("compare") / "compare"
    run_cells(plan, methods, folder)
    return SimpleNamespace(folder=folder, plan=plan, methods=methods)
