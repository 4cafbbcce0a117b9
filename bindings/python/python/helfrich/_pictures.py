"""Pictures of surfaces."""

from __future__ import annotations

import os
from typing import Any, Optional, Sequence, Tuple

import numpy as np

from . import _checks, _helfrich
from ._arrays import both, faces, field, positions


def picture(
    V: Any,
    F: Any = None,
    *,
    values: Any = None,
    error: Any = None,
    directions: Optional[Tuple[Any, Any]] = None,
    limits: Optional[Tuple[float, float]] = None,
    diverging: Optional[bool] = None,
    label: str = "",
    title: str = "",
    edges: bool = False,
    view: Sequence[float] = (0.55, -1.0, 0.62),
    up: Sequence[float] = (0.0, 0.0, 1.0),
    unit: Optional[str] = None,
    size: Tuple[int, int] = (900, 700),
    path: "str | os.PathLike[str] | None" = None,
) -> np.ndarray:
    """A picture of a surface, coloured by values at the vertices, as the program draws it.

    It needs no other package. Diverging colours have the same range on both sides of 0, others go from dark to light.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`.
    values : (n,), optional
        Numbers at the vertices; without them the surface is grey, as it is where they are not finite.
    error : (n,), optional
        Error bars of the values: the surface is grey where twice the bar exceeds the range of the colours.
    directions : pair of (n, 3), optional
        Two unit vectors at the vertices, such as `d1` and `d2` of `curvature`: long and short lines.
    limits : pair of float, optional
        The values at the ends of the colours; by default the smallest and largest, without a few outliers.
    diverging : bool, optional
        Whether colours go both ways from a light one in the middle; by default they do if values have both signs.
    label : str
        Name and unit of the values.
    title : str
    edges : bool
        Whether edges are drawn.
    view, up : (3,)
        The direction from the surface to the viewer, and the one that points upwards.
    unit : str, optional
        Unit of the positions, for a scale bar; without it there is none.
    size : pair of int
        Width and height in pixels, 160 to 4096.
    path : path, optional
        A PNG file for the picture.

    Returns
    -------
    (height, width, 3) uint8
        Red, green and blue, as matplotlib's `imshow` takes them.

    Raises
    ------
    MeshError
        If V and F are no mesh, or values do not fit it.
    ValueError
        If another argument is out of its range.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("discocyte", 642)
    >>> c = helfrich.curvature(V, F)
    >>> helfrich.picture(V, F, values=c.H, error=c.error.H, label="H", size=(400, 300)).shape
    (300, 400, 3)
    """
    V, F = both(V, F)
    V, F = positions(V), faces(F)
    if path is not None:
        path = _checks.path(path, "path")
        if not path.lower().endswith(".png"):
            raise ValueError(f"path is {_checks.shown(path)}: a name that ends in .png is needed")
    if directions is not None:
        first, second = _pair(directions, "directions", "arrays (n, 3)")
        directions = (_field(first, "directions[0]", (len(V), 3)), _field(second, "directions[1]", (len(V), 3)))
    if limits is not None:
        limits = tuple(_checks.number(end, "limits") for end in _pair(limits, "limits", "numbers"))
    return _helfrich.picture(
        V,
        F,
        values=None if values is None else _field(values, "values", (len(V),)),
        error=None if error is None else _field(error, "error", (len(V),)),
        directions=directions,
        limits=limits,
        diverging=None if diverging is None else _checks.flag(diverging, "diverging"),
        label=_checks.text(label, "label"),
        title=_checks.text(title, "title"),
        edges=_checks.flag(edges, "edges"),
        view=_checks.vector(view, "view"),
        up=_checks.vector(up, "up"),
        unit=None if unit is None else _checks.text(unit, "unit"),
        size=tuple(_checks.whole(side, "size", 160, 4096) for side in _pair(size, "size", "whole numbers")),
        path=path,
    )


def _field(given: Any, name: str, shape: Tuple[int, ...]) -> np.ndarray:
    found = field(given, name, shape[0])
    if found.shape != shape:
        raise ValueError(f"{name} has the shape {found.shape}: {shape} is needed")
    return found


def _pair(given: Any, name: str, kind: str) -> Tuple[Any, Any]:
    try:
        first, second = given
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {_checks.shown(given)}: two {kind} are needed") from None
    return first, second
