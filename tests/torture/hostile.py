"""What may be given in place of an argument: wrong types, shapes, numbers, values."""

import datetime
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from tpsim import GMM, S3, Demonstration, Frame, Gaussian, RiemannianGaussian


class Hostile(NamedTuple):
    """One way to spoil an argument.

    Parameters
    ----------
    label : str
    make : callable
        Makes the hostile value, each time anew.
    nonsense : bool
        Whether it can mean nothing, and must be refused where a number belongs.
    """

    label: str
    make: Callable[[], object]
    nonsense: bool = False


class Table:
    """Behaves as a DataFrame does: an array inside, iterating gives the names of columns."""

    def __init__(self, array: np.ndarray):
        self.array, self.columns = array, [f"c{i}" for i in range(array.shape[-1])]
        self.shape = array.shape

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.array, dtype)

    def __iter__(self):
        return iter(self.columns)

    def __len__(self):
        return len(self.array)


class Rude:
    """Raises whatever is asked of it."""

    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("no array")

    def __float__(self):
        raise RuntimeError("no float")

    def __repr__(self):
        raise RuntimeError("no words")

    def __len__(self):
        raise RuntimeError("no length")

    def __iter__(self):
        raise RuntimeError("no items")


def itself() -> list[object]:
    """A list that holds itself."""
    found: list[object] = []
    found.append(found)
    return found


TYPES = [
    Hostile("None", lambda: None),
    Hostile("text", lambda: "abc", True),
    Hostile("no text", lambda: "", True),
    Hostile("text of a number", lambda: "1", True),
    Hostile("bytes", lambda: b"abc", True),
    Hostile("bytearray", lambda: bytearray(b"12"), True),
    Hostile("no dict", dict, True),
    Hostile("dict", lambda: {"a": 1.0}, True),
    Hostile("object", object, True),
    Hostile("rude", Rude, True),
    Hostile("class", lambda: int, True),
    Hostile("function", lambda: len, True),
    Hostile("generator", lambda: (x for x in (1.0, 2.0))),
    Hostile("set", lambda: {1.0, 2.0}, True),
    Hostile("range", lambda: range(3)),
    Hostile("True", lambda: True),
    Hostile("complex", lambda: 1 + 2j, True),
    Hostile("date", lambda: datetime.datetime(2026, 1, 1), True),
    Hostile("duration", lambda: datetime.timedelta(seconds=1), True),
    Hostile("numpy date", lambda: np.datetime64("2026-01-01"), True),
    Hostile("numpy NaT", lambda: np.timedelta64("NaT"), True),
    Hostile("slice", lambda: slice(None), True),
    Hostile("ellipsis", lambda: ..., True),
    Hostile("ragged", lambda: [[1.0], [1.0, 2.0]], True),
    Hostile("list of None", lambda: [None], True),
    Hostile("list of text", lambda: ["a", "b"], True),
    Hostile("list in itself", itself, True),
    Hostile("no list", list),
    Hostile("no tuple", tuple),
    Hostile("no array", lambda: np.empty(0)),
    Hostile("no rows", lambda: np.empty((0, 2))),
    Hostile("no columns", lambda: np.empty((2, 0))),
    Hostile("array of objects", lambda: np.array([object(), None], object), True),
    Hostile("named fields", lambda: np.zeros(2, [("x", float)]), True),
    Hostile("masked", lambda: np.ma.masked_equal([1.0, 9.0], 9.0), True),
    Hostile("a Gaussian", lambda: Gaussian(np.zeros(2), np.eye(2)), True),
]

NUMBERS = [
    Hostile(f"{value:.3g}" if isinstance(value, float) else f"{type(value).__name__} {value}"[:30],
            lambda value=value: value, nonsense)
    for value, nonsense in [
        (float("nan"), True), (np.float64("nan"), True), (float("inf"), False),
        (float("-inf"), True), (-1.0, False), (-1, False), (0, False), (0.0, False), (-0.0, False),
        (0.5, False), (1.5, False), (1, False), (2, False), (3, False), (7, False),
        (1e160, False), (-1e160, False), (1e300, False), (1e90, False), (1e-90, False),
        (1e-150, False), (1e-320, False), (5e-324, False), (10**9, False), (10**12, False),
        (2**63, False), (-(2**63), False), (2**70, False), (10**400, True), (-(10**400), True),
        (np.float32(0.5), False), (np.float16(2), False), (np.uint8(255), False),
        (np.int64(2), False), (np.bool_(True), False), (np.array(2.0), False),
        (np.array([2.0]), False), (np.longdouble(1) / 3, False),
    ]
]  # fmt: skip


def spoiled(array: np.ndarray) -> Iterable[Hostile]:
    """Arrays made of a good one of numbers."""
    a = np.asarray(array, float)
    shapes: dict[str, Callable[[], object]] = {
        "transposed": lambda: a.T.copy(),
        "with an axis in front": lambda: a[None].copy(),
        "with an axis behind": lambda: a[..., None].copy(),
        "without rows": lambda: a[:0].copy(),
        "flat": lambda: a.ravel().copy(),
        "one row": lambda: a[:1].copy(),
        "one sample": lambda: a[0].copy(),
        "without the last row": lambda: a[:-1].copy(),
        "without the last column": lambda: a[..., :-1].copy(),
        "without columns": lambda: a[..., :0].copy(),
        "twice": lambda: np.concatenate([a, a]),
        "twice as wide": lambda: np.concatenate([a, a], -1),
        "backwards": lambda: a[::-1].copy(),
        "one number": lambda: np.array(a.flat[0]),
        "one row many times": lambda: np.repeat(a[:1], len(a), 0),
    }
    numbers: dict[str, Callable[[], object]] = {
        **{f"x {s:g}": lambda s=s: a * s for s in (1e90, 1e-90, 1e-150, 1e-320, 1e12, 1e-12, -1.0)},
        "up to 1e160": lambda: np.clip(a, -1, 1) * 1e160,
        "up to 1e300": lambda: np.clip(a, -1, 1) * 1e300,
        "zeros": lambda: np.zeros_like(a),
        "ones": lambda: np.ones_like(a),
        "one entry huge": lambda: changed(a, 1e150),
        "one entry tiny": lambda: changed(a, 1e-300),
        "+ 1e9": lambda: a + 1e9,
        "unsymmetric": lambda: a + np.triu(np.ones(a.shape[-2:]), 1) if a.ndim > 1 else a + 0.5,
        "singular": lambda: np.ones_like(a) * a.flat[0],
        "halved": lambda: a / 2,
    }
    types: dict[str, Callable[[], object]] = {
        "float16": lambda: a.astype(np.float16),
        "float32": lambda: a.astype(np.float32),
        "long double": lambda: a.astype(np.longdouble),
        "int": lambda: a.astype(int),
        "uint8": lambda: np.abs(a).astype(np.uint8),
        "bool": lambda: a > 0,
        "big-endian": lambda: a.astype(">f8"),
        "Fortran order": lambda: np.asfortranarray(a),
        "strided": lambda: np.repeat(a, 2, -1)[..., ::2] if a.ndim else a,
        "backwards in memory": lambda: a[::-1].copy()[::-1],
        "read-only": lambda: read_only(a),
        "objects": lambda: a.astype(object),
        "list": lambda: a.tolist(),
        "tuple": lambda: tuple(a.tolist()),
        "list of arrays": lambda: list(a.copy()),
        "subclass": lambda: np.ma.array(a),
        "memory": lambda: memoryview(np.ascontiguousarray(a)),
    }
    if a.ndim == 2:
        types |= {"table": lambda: Table(a), "matrix": lambda: np.asmatrix(a.copy())}
    wrong: dict[str, Callable[[], object]] = {
        "one NaN": lambda: changed(a, np.nan),
        "one inf": lambda: changed(a, np.inf),
        "all NaN": lambda: np.full_like(a, np.nan),
        "complex": lambda: a + 1j,
        "text": lambda: a.astype(str),
        "bytes": lambda: a.astype("S"),
        "masked": lambda: np.ma.array(a, mask=np.arange(a.size).reshape(a.shape) == a.size // 2),
        "one None": lambda: changed(a.astype(object), None),
        "one text": lambda: changed(a.astype(object), "x"),
    }
    with np.errstate(all="ignore"):
        if a.ndim and a.size:
            yield from (Hostile(label, make) for label, make in (shapes | numbers | types).items())
            yield from (Hostile(label, make, True) for label, make in wrong.items())
            yield Hostile("dates", lambda: np.zeros(a.shape, "datetime64[s]"), True)
            yield Hostile("durations", lambda: a.astype(int).astype("timedelta64[ms]"), True)


def changed(array: np.ndarray, value: object) -> np.ndarray:
    """The array with one entry, in the middle, replaced."""
    found = array.copy()
    found.flat[found.size // 2] = value
    return found


def read_only(array: np.ndarray) -> np.ndarray:
    """A copy that cannot be written to."""
    found = array.copy()
    found.setflags(write=False)
    return found


def lists(good: object) -> Iterable[Hostile]:
    """Sequences and mappings made of a good one."""
    items = list(good.values()) if isinstance(good, dict) else list(good)
    strange: dict[str, Callable[[], object]] = {
        "the first alone": lambda: items[0],
        "one": lambda: items[:1],
        "twice": lambda: [*items, *items],
        "backwards": lambda: items[::-1],
        "tuple": lambda: tuple(items),
        "iterator": lambda: iter(items),
        "generator": lambda: (item for item in items),
        "dict by number": lambda: dict(enumerate(items)),
        "array of objects": lambda: objects(items),
        "with None": lambda: [*items[:-1], None],
        "with text": lambda: [*items[:-1], "x"],
        "with a number": lambda: [*items[:-1], 1.0],
        "with NaN": lambda: [*items[:-1], float("nan")],
        "nested": lambda: [items],
        "all None": lambda: [None] * len(items),
        "with a class": lambda: [*items[:-1], dict],
        "with rudeness": lambda: [*items[:-1], Rude()],
    }
    yield from (Hostile(label, make) for label, make in strange.items())
    if isinstance(good, dict):
        keys = list(good)
        yield Hostile("numbers as keys", lambda: {i: item for i, item in enumerate(items)})
        yield Hostile("None as values", lambda: dict.fromkeys(keys))
        yield Hostile("text as values", lambda: dict.fromkeys(keys, "x"))
        yield Hostile("numbers as values", lambda: dict.fromkeys(keys, 1.0))
        yield Hostile("other keys", lambda: {f"{k}?": v for k, v in good.items()})
        yield Hostile("pairs", lambda: list(good.items()))


def objects(items: list[object]) -> np.ndarray:
    """Array of objects that numpy does not unpack."""
    found = np.empty(len(items), object)
    for i, item in enumerate(items):
        found[i] = item
    return found


def other_case(text: str) -> str:
    """In capital letters; of a path the name, so that nothing is written elsewhere."""
    folder, _, name = text.rpartition("/")
    return f"{folder}/{name.upper()}" if folder else text.upper()


def relatives(good: object) -> Iterable[Hostile]:
    """Values of the same class that are hard to deal with."""
    if isinstance(good, RiemannianGaussian):
        m, S, on = np.array(good.mean), np.array(good.covariance), good.manifold
        yield Hostile("huge", lambda: RiemannianGaussian(on, m, S * 1e90))
        yield Hostile("tiny", lambda: RiemannianGaussian(on, m, S * 1e-90))
        yield Hostile("thin", lambda: RiemannianGaussian(on, m, thin(S)))
        yield Hostile("of one step", lambda: RiemannianGaussian(on, m[0], S[0]))
        yield Hostile("of more axes", lambda: RiemannianGaussian(on, m[None], S[None]))
        yield Hostile(
            "of another manifold", lambda: RiemannianGaussian(S3, m[..., :4], S[..., :3, :3])
        )
        yield Hostile("plain", lambda: Gaussian(m, np.eye(m.shape[-1])))
    elif isinstance(good, Gaussian):
        m, S = np.array(good.mean), np.array(good.covariance)
        yield Hostile("far away", lambda: Gaussian(m + 1e90, S))
        yield Hostile("huge", lambda: Gaussian(m, S * 1e90))
        yield Hostile("tiny", lambda: Gaussian(m * 1e-90, S * 1e-90))
        yield Hostile("too tiny", lambda: Gaussian.trusted(m * 0, S * 1e-300))
        yield Hostile("thin", lambda: Gaussian(m, thin(S)))
        yield Hostile("of one step", lambda: Gaussian(m.reshape(-1, m.shape[-1])[0],
                                                      S.reshape(-1, *S.shape[-2:])[0]))  # fmt: skip
        yield Hostile("of more axes", lambda: Gaussian(m[None], S[None]))
        yield Hostile("narrower", lambda: Gaussian(m[..., :1], S[..., :1, :1]))
        yield Hostile("wider", lambda: Gaussian(np.concatenate([m, m], -1),
                                                np.eye(2 * m.shape[-1])))  # fmt: skip
    elif isinstance(good, Frame):
        A, b = np.array(good.A), np.array(good.b)
        yield Hostile("singular", lambda: Frame(np.zeros_like(A), b))
        yield Hostile(
            "nearly singular", lambda: Frame(A * np.where(np.arange(A.shape[-1]), 1e-14, 1), b)
        )
        yield Hostile("huge", lambda: Frame(A * 1e90, b * 1e90))
        yield Hostile("tiny", lambda: Frame(A * 1e-90, b * 1e-90))
        yield Hostile("far away", lambda: Frame(A, b + 1e90))
        yield Hostile("of more axes", lambda: Frame(A[None], b[None]))
        yield Hostile("moving otherwise", lambda: Frame(np.stack([A, A, A]), np.stack([b, b, b])))
        yield Hostile("narrower", lambda: Frame(A[..., :1], b))
        yield Hostile("of another space", lambda: Frame(A[..., :1, :], b[..., :1]))
    elif isinstance(good, Demonstration):
        t, x, f = np.array(good.time), np.array(good.data), good.frames
        yield Hostile("one sample", lambda: Demonstration(t[:1], x[:1], of_step(f, 1)))
        yield Hostile("two samples", lambda: Demonstration(t[:2], x[:2], of_step(f, 2)))
        yield Hostile("still", lambda: Demonstration(t, x * 0 + 1, f))
        yield Hostile("huge", lambda: Demonstration(t, x * 1e90, f))
        yield Hostile("tiny", lambda: Demonstration(t, x * 1e-90, f))
        yield Hostile("too tiny", lambda: Demonstration(t, x * 1e-150, f))
        yield Hostile("far away", lambda: Demonstration(t, x + 1e12, f))
        yield Hostile("fast", lambda: Demonstration(t * 1e-90, x, f))
        yield Hostile("slow", lambda: Demonstration(t * 1e90, x, f))
        yield Hostile("unevenly sampled", lambda: Demonstration(t**3 + t, x, f))
        yield Hostile("without frames", lambda: Demonstration(t, x))
        yield Hostile("with fewer frames", lambda: Demonstration(t, x, f[:-1]))
        yield Hostile("narrower", lambda: Demonstration(t, x[:, :1]))
        yield Hostile("an outlier", lambda: Demonstration(t, changed(x, 1e50), f))
        yield Hostile(
            "one column still", lambda: Demonstration(t, x * np.r_[0, np.ones(x.shape[1] - 1)], f)
        )
    elif isinstance(good, GMM):
        g = good.gaussians
        yield Hostile("a prior of zero", lambda: GMM(np.eye(len(good.priors))[0], g))
        yield Hostile("one component", lambda: GMM(np.ones(1), g[:1]))
        yield Hostile(
            "tiny", lambda: GMM(good.priors, Gaussian(g.mean * 1e-90, g.covariance * 1e-90))
        )
        yield Hostile("huge", lambda: GMM(good.priors, Gaussian(g.mean, g.covariance * 1e90)))
        yield Hostile("equal components", lambda: GMM(good.priors, g[[0] * len(good.priors)]))


def of_step(frames: tuple[Frame, ...], count: int) -> list[Frame]:
    """The frames of the first steps."""
    return [frame[:count] if frame.shape else frame for frame in frames]


def thin(S: np.ndarray) -> np.ndarray:
    """Covariances with hardly any extent in one direction."""
    values, V = np.linalg.eigh(S)
    values[..., 0] *= 1e-14
    return (V * values[..., None, :]) @ V.mT


def numeric(good: object) -> bool:
    """Whether a number or numbers belong here."""
    if isinstance(good, bool | np.bool_):
        return False
    if isinstance(good, int | float | np.number | np.ndarray):
        return True
    parts = list(good) if isinstance(good, list | tuple) else []
    shapes = {np.shape(part) for part in parts if numeric(part)}
    return bool(parts) and all(numeric(part) for part in parts) and len(shapes) == 1


def corruptions(good: object) -> list[Hostile]:
    """All ways to spoil one argument whose good value is given."""
    number = numeric(good)
    found = [h._replace(nonsense=h.nonsense and number) for h in TYPES + NUMBERS]
    if callable(good):  # what a function of yours does is yours
        found = [h for h in found if h.label not in ("class", "function")]
    if number:
        found += list(spoiled(np.asarray(good, float)))
    if isinstance(good, list | tuple | dict) and len(good) and not hasattr(good, "_fields"):
        found += list(lists(good))
        first = next(iter(good.values())) if isinstance(good, dict) else good[0]
        for one in relatives(first):
            found.append(Hostile(f"first {one.label}", lambda one=one: put(good, one.make())))
            found.append(Hostile(f"all {one.label}", lambda one=one: put_all(good, one.make())))
    found += list(relatives(good))
    if isinstance(good, str):
        found += [
            Hostile("other case", lambda: other_case(good)),
            Hostile("with a null", lambda: good + "\0"),
            Hostile("very long", lambda: good * 10**5),
            Hostile("of other letters", lambda: "żółć\n☃"),
            Hostile("list of it", lambda: [good]),
            Hostile("numpy text", lambda: np.str_(good)),
        ]
    return found


def put(good: object, value: object) -> object:
    """The sequence or mapping with its first item replaced."""
    if isinstance(good, dict):
        return {**good, next(iter(good)): value}
    return [value, *list(good)[1:]]


def put_all(good: object, value: object) -> object:
    """The sequence or mapping with all items replaced."""
    return dict.fromkeys(good, value) if isinstance(good, dict) else [value for _ in good]
