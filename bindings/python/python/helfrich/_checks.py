"""Checks of arguments that are no arrays. Each error names the argument, its limits, and what would be right.

The compiled module calls these functions, too.
"""

from __future__ import annotations

import operator
import os
from typing import Any, List, Mapping, Optional

import numpy as np

LONGEST = 60
"""Characters of a value that a message shows, and of a name that is looked up."""


def shown(value: Any) -> str:
    """The value in a message, cut if it is long."""
    try:
        text = repr(value)
    except Exception:  # noqa: BLE001, whatever a class of others raises
        text = f"<{type(value).__name__}>"
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}…"


def whole(value: Any, name: str, least: int, most: int) -> int:
    """A whole number between two others."""
    needed = f"a whole number from {least} to {most} is needed"
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} is {value}: {needed}")
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {shown(value)}: {needed}") from None
    if not least <= number <= most:
        raise ValueError(f"{name} is {shown(number)}, out of range: {least} to {most} are possible")
    return number


def count(value: Any, name: str) -> Optional[int]:
    """The number of vertices of a mesh, or None."""
    # As many as a mesh may have.
    return None if value is None else whole(value, name, 1, (2**32 - 1) // 6)


def threads(value: Any, name: str = "threads") -> Optional[int]:
    """The number of threads, or None for all."""
    return None if value is None else whole(value, name, 1, 1024)


def number(value: Any, name: str) -> float:
    """A number that is finite."""
    kind = getattr(getattr(value, "dtype", None), "kind", "f")
    is_number = hasattr(value, "__float__") and kind in tuple("fiu")
    if not is_number or isinstance(value, bool) or value is np.ma.masked:
        raise TypeError(f"{name} is {shown(value)}: a finite number is needed")
    try:
        found = float(value)
    except OverflowError:
        found = np.inf
    except Exception:  # noqa: BLE001, arrays of several numbers, and whatever a class of others raises
        raise TypeError(f"{name} is {shown(value)}: one finite number is needed") from None
    if not np.isfinite(found):
        raise ValueError(f"{name} is {shown(value)}, not a finite number: one is needed")
    return found


def length(value: Any, name: str) -> float:
    """A length of 0 or more."""
    found = number(value, name)
    if found < 0:
        raise ValueError(f"{name} is {found}: a length of 0 or more is needed")
    return found


def positive_length(value: Any, name: str) -> float:
    """A length above 0."""
    found = number(value, name)
    if found <= 0:
        raise ValueError(f"{name} is {found}: a length above 0 is needed")
    return found


def vector(value: Any, name: str) -> List[float]:
    """Three finite numbers."""
    needed = f"{name} is {shown(value)}: three finite numbers are needed"
    try:
        entries = list(value)
    except TypeError:
        raise TypeError(needed) from None
    if isinstance(value, (str, bytes)) or len(entries) != 3:
        raise TypeError(needed)
    return [number(entry, f"{name}[{place}]") for place, entry in enumerate(entries)]


def flag(value: Any, name: str) -> bool:
    """True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} is {shown(value)}: True or False is needed")
    return bool(value)


def mapping(value: Any, name: str) -> Mapping[str, Any]:
    """A mapping, or none."""
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise TypeError(f"{name} is {shown(value)}: a dict is needed")
    return value


def text(value: Any, name: str) -> str:
    """A name that is looked up."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is {shown(value)}: a text is needed")
    if len(value) > LONGEST:
        raise ValueError(f"{name} is {shown(value)}: no name has more than {LONGEST} characters")
    return unicode(value, name)


def unicode(value: str, name: str) -> str:
    """A text that can be written in UTF-8."""
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name} is {shown(value)}, which is no text in UTF-8: remove the surrogates") from None
    return value


def texts(value: Any, name: str) -> List[str]:
    """Names that are looked up."""
    try:
        entries = [] if isinstance(value, (str, bytes)) else list(value)
    except TypeError:
        entries = []
    if not entries:
        raise TypeError(f"{name} is {shown(value)}: a list of names is needed, one or more")
    return [text(entry, f"{name}[{place}]") for place, entry in enumerate(entries)]


def option(value: Any, name: str) -> Optional[str]:
    """The value of an option of methods as text: a name or a number, or None."""
    if value is None or isinstance(value, str):
        return None if value is None else text(value, name)
    return repr(number(value, name))


def path(value: Any, name: str) -> str:
    """A path of a file or folder."""
    try:
        found = os.fsdecode(value)
    except TypeError:
        raise TypeError(f"{name} is {shown(value)}: a path is needed, a text or a pathlib.Path") from None
    if "\0" in found:
        raise ValueError(f"{name} is {shown(found)}: no path has a zero character")
    try:
        found.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        raise ValueError(f"{name} is {shown(found)}, which is no path: remove the surrogates") from None
    return found


def called(value: Any, name: str) -> Any:
    """A function, or None."""
    if value is not None and not callable(value):
        raise TypeError(f"{name} is {shown(value)}: a function is needed")
    return value
