"""Linear algebra on one thread: results must not depend on the cores of a machine.

BLAS sums in another order on more threads, and so in other bits. Environment variables count only
before numpy is loaded; what is done here counts from within, in this process.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from threading import Lock, local

from threadpoolctl import LibController, ThreadpoolController

_lock = Lock()
_depth = 0
_blas: list[tuple[LibController, int]] = []
_own = local()


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep BLAS and OpenMP on one thread in this block; as a decorator, in a function.

    BLAS has one limit in a process: who comes first sets it and who leaves last takes it away, so
    that blocks may be nested and may overlap in several threads of a program. OpenMP has one in
    each of those.
    """
    global _depth
    first = not getattr(_own, "inside", False)
    if first:
        _own.inside, openmp = True, _limited("openmp")
    with _lock:
        if _depth == 0:
            _blas[:] = _limited("blas")
        _depth += 1
    try:
        yield
    finally:
        with _lock:
            _depth -= 1
            if _depth == 0:
                _restore(_blas)
        if first:
            _restore(openmp)
            _own.inside = False


def _limited(kind: str) -> list[tuple[LibController, int]]:
    """Libraries that had more threads than one before this call, and how many."""
    found = [(library, library.num_threads) for library in _libraries(kind).lib_controllers]
    before = [(library, count) for library, count in found if count != 1]
    _restore([(library, 1) for library, _ in before])
    return before


def _restore(before: list[tuple[LibController, int]]) -> None:
    for library, count in before:
        _let_any_thread(library)
        library.set_num_threads(count)
        _let_any_thread(library)


def _let_any_thread(library: LibController) -> None:
    """Let the thread that comes next set the limit of OpenBLAS.

    threadpoolctl 3.7 and later otherwise hears none but the first that did.
    """
    if hasattr(library, "clear_controlling_thread"):
        library.clear_controlling_thread(force=True)


def linear_algebra() -> str:
    """The BLAS libraries at work, such as ``"openblas 0.3.30 Haswell, 1 thread"``.

    Bits depend on the library and on the kind of processor that its kernels are made for.
    """
    found = _libraries("blas").info()
    return "; ".join(
        " ".join(
            filter(None, (pool["internal_api"], pool["version"], pool.get("architecture", "")))
        )
        + f", {pool['num_threads']} thread{'s' * (pool['num_threads'] != 1)}"
        for pool in sorted(found, key=lambda pool: str(pool["version"]))
    )


def _libraries(kind: str) -> ThreadpoolController:
    # Only a library that is loaded can be limited: numpy and scipy bring one each.
    import scipy.linalg

    assert scipy.linalg
    return _loaded(kind, len(sys.modules))


@lru_cache(maxsize=2)
def _loaded(kind: str, modules: int) -> ThreadpoolController:
    """What is loaded; looked for again only after something was imported, since it takes 4 ms."""
    return ThreadpoolController().select(user_api=kind)
