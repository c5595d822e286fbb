"""Units of files, as factors to SI."""

import math
import re

TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}
LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
ANGLE = {"rad": 1.0, "deg": math.pi / 180}

_WRITTEN = {"sec": "s", "secs": "s", "seconds": "s", "µs": "us", "μs": "us", "°": "deg"}
_WRITTEN |= {"degrees": "deg", "degree": "deg", "radians": "rad", "meters": "m", "msec": "ms"}
_BRACKETS = re.compile(r"\s*[\[(]\s*([^\[\]()]*?)\s*[\])]$")

# Unix time was 1e9 s in 2001 and will be 1e10 s in 2286.
_UNIX = (("ns", 1e17, 1e20), ("us", 1e14, 1e17), ("ms", 1e11, 1e14))


def name_and_unit(text: str) -> tuple[str, str | None]:
    """Split a heading such as ``"x [mm]"`` or ``"time (s)"`` in its name and its unit."""
    text = text.strip().strip('"').strip()
    match = _BRACKETS.search(text)
    if match and (unit := _WRITTEN.get(match[1], match[1])) in {"", *TIME, *LENGTH, *ANGLE}:
        return text[: match.start()].strip(), unit or None
    if match and re.search(r"[/^*·²]|^[A-Z%]", match[1]):
        return text[: match.start()].strip(), match[1]
    return text, None


def unit_of_stamps(name: str, last: float) -> str:
    """Guess the unit of stamps from the column's name, then from what Unix time looks like."""
    ending = re.search(r"_(s|ms|us|ns|sec|secs|msec)$", name.lower())
    if ending:
        return _WRITTEN.get(ending[1], ending[1])
    return next((unit for unit, low, high in _UNIX if low <= abs(last) < high), "s")
