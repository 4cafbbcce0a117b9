"""The exception for meshes that are none, and the warning about results on others."""

from __future__ import annotations

import sys
import warnings
from typing import Optional, Tuple


class MeshError(ValueError):
    """The reason why arrays are no mesh, with its place.

    Attributes
    ----------
    face, vertex : int or None
        The face or the vertex that is wrong, counted from 0.
    edge : (int, int) or None
        The vertices of the edge that is wrong.

    Examples
    --------
    >>> import helfrich
    >>> try:
    ...     helfrich.mean_curvature([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]])
    ... except helfrich.MeshError as error:
    ...     print(error.face, error.vertex)
    0 7
    """

    def __init__(
        self,
        message: str,
        *,
        face: Optional[int] = None,
        edge: Optional[Tuple[int, int]] = None,
        vertex: Optional[int] = None,
    ) -> None:
        super().__init__(message)
        self.face = face
        self.edge = edge
        self.vertex = vertex


class MeshWarning(UserWarning):
    """A result that means something else on this mesh than on others, such as an energy without the border.

    Examples
    --------
    >>> import helfrich, warnings
    >>> V, F, _ = helfrich.shape("sphere", 162)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", helfrich.MeshWarning)
    ...     try:
    ...         helfrich.bending_energy(V, F[1:])
    ...     except helfrich.MeshWarning as warning:
    ...         print("leaves out" in str(warning))
    True
    """


def warn(text: str) -> None:
    """Warns of a result at the line that has called this package."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("helfrich."):
        frame, level = frame.f_back, level + 1
    warnings.warn(text, MeshWarning, stacklevel=level)
