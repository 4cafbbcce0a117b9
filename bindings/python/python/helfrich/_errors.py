"""The exception for meshes that are none."""

from __future__ import annotations

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
