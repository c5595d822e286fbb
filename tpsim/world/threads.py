"""Linear algebra on one thread: results must not depend on the cores of a machine.

BLAS sums in another order on more threads, and so in other bits. Environment variables count only
before numpy is loaded; what is done here counts from within, in this process.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from threading import Lock

from threadpoolctl import ThreadpoolController

_lock = Lock()
_depth = 0
_before: list = []


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep BLAS and OpenMP on one thread in this block; as a decorator, in a function.

    Who comes first sets the limit and who leaves last takes it away, so that blocks may be nested
    and may overlap in several threads of a program.
    """
    global _depth
    with _lock:
        if _depth == 0:
            _before.append(_libraries().limit(limits=1))
        _depth += 1
    try:
        yield
    finally:
        with _lock:
            _depth -= 1
            if _depth == 0:
                _before.pop().restore_original_limits()


def linear_algebra() -> str:
    """The BLAS libraries at work, such as ``"openblas 0.3.30 Haswell, 1 thread"``.

    Bits depend on the library and on the kind of processor that its kernels are made for.
    """
    found = [pool for pool in _libraries().info() if pool["user_api"] == "blas"]
    return "; ".join(
        " ".join(
            filter(None, (pool["internal_api"], pool["version"], pool.get("architecture", "")))
        )
        + f", {pool['num_threads']} thread{'s' * (pool['num_threads'] != 1)}"
        for pool in sorted(found, key=lambda pool: str(pool["version"]))
    )


def _libraries() -> ThreadpoolController:
    # Only a library that is loaded can be limited: numpy and scipy bring one each.
    import scipy.linalg

    assert scipy.linalg
    return _loaded(len(sys.modules))


@lru_cache(maxsize=1)
def _loaded(modules: int) -> ThreadpoolController:
    """What is loaded; looked for again only after something was imported, since it takes 4 ms."""
    return ThreadpoolController()
