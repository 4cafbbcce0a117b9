"""The smooth surface through the vertices of a mesh."""

from __future__ import annotations

from typing import Any, NamedTuple, Tuple

import numpy as np

from . import _checks, _helfrich
from ._arrays import both


class SurfacePoints(NamedTuple):
    """Points of a `Surface`. Arrays are (k,) or (k, 3), float64.

    Where there is no fit, curvatures are 0 and error bars infinite.
    """

    position: np.ndarray
    """Position (k, 3)."""
    normal: np.ndarray
    """Outward unit normal (k, 3)."""
    d1: np.ndarray
    """Unit vector (k, 3) along k1, 0 at umbilics."""
    H: np.ndarray
    """Mean curvature (k1 + k2)/2, 1/length, positive on a sphere."""
    K: np.ndarray
    """Gaussian curvature k1 k2, 1/length²."""
    k1: np.ndarray
    """The larger principal curvature."""
    k2: np.ndarray
    """The smaller principal curvature."""
    position_error: np.ndarray
    """Error bar of the position along the normal if the vertices are exact, a length; 0 at vertices."""
    H_error: np.ndarray
    """Estimated error of H if the vertices are exact."""
    K_error: np.ndarray
    """Estimated error of K if the vertices are exact."""


class Surface:
    """The smooth surface through the vertices of a mesh, made by `surface`."""

    def __init__(self, V: Any, F: Any = None, *, method: str = "jet") -> None:
        V, F = both(V, F)
        method = _checks.text(method, "method")
        if method not in ("jet", "j4", "j6", "j8"):
            raise ValueError(f"method is {method!r}: 'jet', 'j4', 'j6' and 'j8' have a smooth surface")
        self._surface = _helfrich.SmoothSurface(V, F, method)

    def at(self, faces: Any, weights: Any) -> SurfacePoints:
        """The points over places of the mesh.

        Parameters
        ----------
        faces : (k,) integers
            The face of each place.
        weights : (k, 3)
            The weights of its corners: at least 0, with the sum 1.

        Raises
        ------
        ValueError
            If there is no such face, or a row is no weight of corners.
        """
        faces = np.atleast_1d(np.asarray(faces))
        if faces.ndim != 1 or faces.dtype.kind not in "iu" or (faces < 0).any():
            raise ValueError("faces has to be one-dimensional, with integers of at least 0")
        return SurfacePoints(**self._surface.at(faces.tolist(), np.atleast_2d(np.asarray(weights))))

    def project(self, points: Any) -> Tuple[np.ndarray, np.ndarray]:
        """The places that are nearest to points (k, 3): faces (k,), uint32, and weights of corners (k, 3).

        Raises
        ------
        ValueError
            If a coordinate is not finite.
        """
        return self._surface.project(np.atleast_2d(np.asarray(points)))


def surface(V: Any, F: Any = None, *, method: str = "jet") -> Surface:
    """The smooth surface through the vertices: position, normal and curvatures at any point.

    Polynomials are fitted around each vertex, once, and blended over the faces. Positions have errors of order d + 1 in
    the edge length with polynomials of degree d, H and K of order d − 1.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`. Its positions are taken as exact.
    method : str
        The degree of the polynomials: "j4", "j6" or "j8", or "jet", which chooses by the number of vertices.

    Returns
    -------
    Surface
        Its method `at` has the points, and `project` finds the places that are nearest to given ones.

    Raises
    ------
    MeshError
        If V and F are no mesh.
    ValueError
        If the method has no smooth surface.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("sphere", 642)
    >>> smooth = helfrich.surface(V, F)
    >>> faces, weights = smooth.project([[0.0, 0.0, 1.2]])
    >>> found = smooth.at(faces, weights)
    >>> round(float(found.position[0, 2]), 4), round(float(found.H[0]), 4)
    (1.0, 1.0)
    """
    return Surface(V, F, method=method)
