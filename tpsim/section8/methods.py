"""The methods that are compared, by name, and those that a user brings."""

import importlib.util
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import cloudpickle

from tpsim.errors import ArgumentError
from tpsim.section8 import in_frames, peers, without_frames
from tpsim.section8.method import Method

METHODS: dict[str, Method] = {
    "TP-GMM": in_frames.tp_gmm,
    "TP-GMR": in_frames.tp_gmr,
    "TP-GMR full": in_frames.tp_gmr_with("full"),
    "TP-GMR diagonal": in_frames.tp_gmr_with("diagonal"),
    "TP-GMR held": in_frames.tp_gmr_with("full", "held"),
    "TP-GMR pooled": in_frames.tp_gmr_with("full", "pooled"),
    "TP-GMR product": in_frames.tp_gmr_with("full", "product"),
    "TP-MFA": in_frames.tp_mfa,
    "TP-HDDC": in_frames.tp_hddc,
    "TP-MPPCA": in_frames.tp_mppca,
    "TP-trajGMM": in_frames.tp_trajectory_gmm,
    "TP-LQT": in_frames.tp_lqt,
    "TP-GP": in_frames.tp_gp,
    "TP-LWR": in_frames.tp_lwr,
    "TP-KMP": in_frames.tp_kmp,
    "TP-ProMP": in_frames.tp_promp,
    "TP-trajDistrib": in_frames.tp_trajectory_distribution,
    "GPR": without_frames.gpr,
    "GPR-GMM": without_frames.gpr_gmm,
    "PGMM": without_frames.pgmm,
    "ProMP": without_frames.promp,
    "KMP": without_frames.kmp,
    "DMP": without_frames.dmp,
    "gmr: TP-GMM": peers.gmr_library,
    "movement_primitives: ProMP": peers.promp_library,
    "movement_primitives: DMP": peers.dmp_library,
    "lc-ns-kmp: KMP": peers.kmp_library,
}
"""Methods of Section 8 and of Figs 12 to 14, their relatives, and other people's libraries."""

PICTURED = (
    "TP-GMM",
    "TP-GMR",
    "TP-GMR product",
    "TP-MFA",
    "TP-trajGMM",
    "TP-GP",
    "TP-LWR",
    "TP-ProMP",
    "KMP",
    "GPR",
    "GPR-GMM",
    "PGMM",
    "DMP",
)
"""Methods that the picture in the layout of Figs 12 to 14 shows."""


def method_from(specification: str) -> Method:
    """Load a user's method named ``file.py:function``.

    Raises
    ------
    ArgumentError
        Another form, no such file, a file that fails, or no such function in it.
    """
    name, colon, function = specification.rpartition(":")
    path = Path(name)
    if not colon or not function or not path.is_file():
        raise ArgumentError(f"--method {specification}: give file.py:function, an existing file")
    spec = importlib.util.spec_from_file_location(f"_method_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise ArgumentError(f"--method {specification}: {path} is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise ArgumentError(
            f"--method {specification}: {path} fails with {type(error).__name__}: {error}"
        ) from error
    cloudpickle.register_pickle_by_value(module)  # workers cannot import it
    found = getattr(module, function, None)
    if not callable(found):
        raise ArgumentError(f"--method {specification}: {path} has no function {function!r}")
    return found


def with_methods_from(
    specifications: Sequence[str], methods: Mapping[str, Method] = METHODS
) -> dict[str, Method]:
    """Methods with those added that are named ``file.py:function``, under the function's name."""
    extended = dict(methods)
    for specification in specifications:
        name = specification.rpartition(":")[2]
        if name in extended:
            raise ArgumentError(f"--method {specification}: there is already a method {name!r}")
        extended[name] = method_from(specification)
    return extended
