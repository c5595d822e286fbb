"""Dask workers in the place of processes, behind the same seam: concurrent.futures.Executor."""

import logging
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from tpsim.errors import SimulationError, one_line
from tpsim.extras import extra

if TYPE_CHECKING:
    from distributed import Client

LOCAL = "local"

PATIENCE = 10.0
"""Time [s] in which a scheduler has to answer, and after which it counts as gone."""

_LOOK = 0.5


@contextmanager
def dask(address: str, workers: int) -> "Iterator[tuple[Callable[[int], Executor], int]]":
    """Connect to a Dask cluster; gives what makes executors on it, and how many workers it has.

    Parameters
    ----------
    address : str
        Of a scheduler, such as ``tcp://node:8786``, whoever started it; or ``"local"``.
    workers : int
        Processes of a local cluster.

    Raises
    ------
    SimulationError
        If no scheduler answers there, or it has no workers.
    """
    with extra("Clusters", "cluster"):
        from distributed import Client, LocalCluster
    # What it logs in paragraphs is said in one line here.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    if address == LOCAL:
        with (
            LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=":0",
                silence_logs=logging.ERROR,
            ) as there,
            Client(there) as client,
        ):
            yield (lambda _: DaskExecutor(client)), workers
        return
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise SimulationError(
            f"no Dask scheduler answers at {address} ({one_line(error, 100)}); start one with "
            "dask scheduler, and workers with dask worker ADDRESS --nthreads 1"
        ) from None
    with client:
        yield (lambda _: DaskExecutor(client)), _count(client, address)


def _count(client: "Client", address: str) -> int:
    """Threads of the workers there are; SimulationError if none comes in time."""
    for _ in range(round(PATIENCE / _LOOK)):
        if count := sum(client.nthreads().values()):
            return int(count)
        time.sleep(_LOOK)
    raise SimulationError(
        f"the scheduler at {address} has no workers; start some with dask worker {address} "
        "--nthreads 1"
    )


class DaskExecutor(Executor):
    """What is submitted is done on the workers of a cluster; a death there is done again there.

    Parameters
    ----------
    client : distributed.Client
    """

    def __init__(self, client: "Client"):
        self._client = client
        self._running: dict[Future, Any] = {}
        self._closed = threading.Event()
        threading.Thread(target=self._watch, daemon=True).start()

    def submit(self, fn: Callable, /, *args: Any, **kwargs: Any) -> Future:
        """Submit a call; a worker that dies often under it breaks the executor, as loky's."""
        found: Future = Future()
        try:
            there = self._client.submit(fn, *args, pure=False, **kwargs)
        except Exception as error:
            raise _gone(error) from None
        self._running[found] = there
        there.add_done_callback(lambda _: self._finish(found))
        return found

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Forget what is not done; the cluster stays."""
        self._closed.set()
        left, self._running = self._running, {}
        if self._client.status == "running":  # else it would wait for a scheduler that is gone
            for there in left.values():
                there.cancel()

    def _finish(self, found: Future) -> None:
        from distributed import CancelledError, KilledWorker

        there = self._running.pop(found, None)
        if there is None or found.done():
            return
        try:
            found.set_result(there.result(timeout=PATIENCE))
        except KilledWorker as error:
            found.set_exception(BrokenExecutor(one_line(error, 100)))
        except CancelledError as error:
            found.set_exception(_gone(error))
        except Exception as error:
            found.set_exception(error)

    def _watch(self) -> None:
        """Give up what runs when the scheduler is gone: nobody else would say so."""
        silent = 0.0
        while not self._closed.wait(_LOOK):
            silent = 0.0 if self._client.status == "running" else silent + _LOOK
            if silent > 2 * _LOOK:
                for found in list(self._running):
                    self._running.pop(found, None)
                    if not found.done():
                        found.set_exception(_gone(self._client.status))


def _gone(why: object) -> SimulationError:
    return SimulationError(
        f"the Dask scheduler is gone ({one_line(why, 80)}); what is done is kept: start it again "
        "and run the same command"
    )
