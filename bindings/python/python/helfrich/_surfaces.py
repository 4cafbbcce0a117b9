"""The smooth surface through the vertices of a mesh."""

from __future__ import annotations

from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from . import _checks, _helfrich
from ._arrays import both
from ._errors import warn


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
        return SurfacePoints(**self._surface.at(*_places(faces, weights)))

    def interpolate(self, field: Any, faces: Any, weights: Any) -> Tuple[np.ndarray, np.ndarray]:
        """A field at the vertices, between them: values and error bars (k,), as smooth as the surface.

        Polynomials are fitted as to the positions, and errors have the same order. Where there is no fit, values are
        linear, and error bars infinite.

        Parameters
        ----------
        field : (n,)
            The values at the vertices.
        faces, weights
            The places, as in `at`.

        Raises
        ------
        ValueError
            If a vertex has no finite value, there is no such face, or a row is no weight of corners.
        """
        return self._surface.interpolate(_numbers(field, "field").tolist(), *_places(faces, weights))

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
        Its method `at` has the points, `project` finds the places that are nearest to given ones, and `interpolate`
        has fields there.

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


class Remeshed(NamedTuple):
    """A new mesh, made by `remesh`."""

    vertices: np.ndarray
    """Positions V (n, 3) float64."""
    faces: np.ndarray
    """Triangles F (m, 3) uint32."""
    face_of: np.ndarray
    """The face of the old mesh on which each vertex is, (n,) uint32."""
    weights: np.ndarray
    """The weights of the corners of that face, (n, 3)."""
    position_error: np.ndarray
    """Error bar of each position, a length; infinite where a vertex is on a flat face."""
    fields: Dict[str, np.ndarray]
    """The fields at the new vertices, (n,)."""


def remesh(
    V: Any,
    F: Any = None,
    *,
    vertices: Optional[int] = None,
    edge: Any = None,
    curvature: Optional[float] = None,
    error: Optional[float] = None,
    creases: float = 60.0,
    smooth: bool = False,
    fields: Optional[Mapping[str, Any]] = None,
) -> Remeshed:
    """A new mesh with even triangles of the smooth surface through the vertices.

    Vertices lie on polynomials fitted to the old ones, so that curvatures of the new mesh are as accurate as those of the
    old one. Borders and creases keep their curves. By default the number of vertices stays the same.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`.
    vertices : int, optional
        The number of vertices; lengths are then relative to each other.
    edge : float or (n,), optional
        The length of the edges, or one at each vertex.
    curvature : float, optional
        Lengths by curvature: no edge turns by more than this angle, in degrees.
    error : float, optional
        Edges as long as the error of H may be at most this part of the largest ``|H|``.
    creases : float
        Edges at which faces differ by more than this angle, in degrees, are kept as creases.
    smooth : bool
        Removes the noise of the positions first.
    fields : dict, optional
        Numbers at vertices (n,), which are carried to the new ones: integers as labels, others as smooth fields.

    Returns
    -------
    Remeshed
        `vertices faces face_of weights position_error fields`.

    Raises
    ------
    MeshError
        If V and F are no mesh.
    ValueError
        If the positions are noisy, if faces would cross, or if an argument is out of its range.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("torus:1,0.4", 642, family="irregular")
    >>> new = helfrich.remesh(V, F, vertices=800, fields={"height": V[:, 2]})
    >>> len(new.vertices), helfrich.check(new.vertices, new.faces).genus
    (800, 1)
    >>> bool(abs(new.fields["height"] - new.vertices[:, 2]).max() < 1e-2)
    True
    """
    V, F = both(V, F)
    if sum(given is not None for given in (edge, curvature, error)) > 1:
        raise ValueError("edge, curvature and error are given together: one of them is needed")
    if edge is not None:
        if np.ndim(edge) == 0:
            edge = _positive(edge, "edge")
        else:
            edge = _numbers(edge, "edge")
            if not (edge > 0).all():
                raise ValueError("edge has lengths that are not above 0")
    found = _helfrich.remesh(
        V,
        F,
        vertices=None if vertices is None else _checks.whole(vertices, "vertices", 4, 2**29),
        edge=edge if edge is None or isinstance(edge, float) else edge.tolist(),
        curvature=None if curvature is None else _positive(curvature, "curvature"),
        error=None if error is None else _positive(error, "error"),
        creases=_positive(creases, "creases"),
        smooth=_checks.flag(smooth, "smooth"),
        fields=[(_checks.text(name, "fields"), _numbers(field, "fields", known=False).tolist())
                for name, field in _checks.mapping(fields, "fields").items()],
    )
    mesh, places, errors, carried = found
    return Remeshed(*mesh, *places, errors, carried)


def _places(faces: Any, weights: Any) -> Tuple[List[int], np.ndarray]:
    """Faces and weights of corners, as the compiled module takes them."""
    faces = np.atleast_1d(np.asarray(faces))
    if faces.ndim != 1 or faces.dtype.kind not in "iu" or (faces < 0).any():
        raise ValueError("faces has to be one-dimensional, with integers of at least 0")
    return faces.tolist(), np.atleast_2d(np.asarray(weights))


class Smoothed(NamedTuple):
    """Smoother positions, made by `smooth`."""

    vertices: np.ndarray
    """Positions V (n, 3) float64."""
    noise: float
    """Standard deviation of the original positions along the normals, a length; 0 if none is seen."""
    noise_in_edges: float
    """The same in mean lengths of an edge."""
    degree: int
    """Degree of the fits onto which vertices were moved; 0 if they were moved by flow or not at all."""
    scale: int
    """Number of neighbours of these fits; 0 without fits."""
    displacement: float
    """Root mean square of the displacements, a length."""
    largest_displacement: float
    """The largest of them."""
    area: Tuple[float, float]
    """Area before and after."""
    volume: Optional[Tuple[float, float]]
    """Enclosed volume before and after; None on an open mesh."""


def smooth(
    V: Any,
    F: Any = None,
    *,
    scale: Optional[int] = None,
    flow: Optional[float] = None,
    threads: Optional[int] = None,
) -> Smoothed:
    """The mesh with smoother positions: without its noise, or after mean-curvature flow.

    By default noise is measured, and vertices move along their normals onto polynomials fitted to their neighbours, at
    the scale that the noise asks for. Closed components keep their volumes. Positions without noise keep their bits.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`.
    scale : int, optional
        Number of neighbours of the fits, 28 to 4096, whatever the noise is: more of them smooth more. These fits have
        degree 4.
    flow : float, optional
        Time of one implicit step of mean-curvature flow instead of fits, a length squared: waves of length L are
        multiplied by 1/(1 + 4 π² flow/L²). Borders stay where they are.
    threads : int, optional
        Number of threads; the result does not depend on it.

    Returns
    -------
    Smoothed
        `vertices noise noise_in_edges degree scale displacement largest_displacement area volume`.

    Raises
    ------
    MeshError
        If V and F are no mesh.
    ValueError
        If both `scale` and `flow` are given, if one is out of its range, or if a volume cannot be kept.

    Warns
    -----
    MeshWarning
        If there is noise that no fits reduce: no vertex is moved.

    Examples
    --------
    >>> import helfrich, numpy as np
    >>> V, F, _ = helfrich.shape("sphere", 642, family="irregular")
    >>> noisy = V + 2e-3 * np.random.default_rng(1).standard_normal(V.shape)
    >>> found = helfrich.smooth(noisy, F)
    >>> off = [abs(np.linalg.norm(x, axis=1) - 1).mean() for x in (noisy, found.vertices)]
    >>> bool(off[1] < off[0] / 2), abs(found.volume[1] / found.volume[0] - 1) < 1e-12
    (True, True)
    """
    V, F = both(V, F)
    if scale is not None and flow is not None:
        raise ValueError("scale and flow are given together: one of them is needed, or none")
    found, reason = _helfrich.smooth(
        V,
        F,
        scale=None if scale is None else _checks.whole(scale, "scale", 28, 4096),
        flow=None if flow is None else _positive(flow, "flow"),
        threads=_checks.threads(threads),
    )
    if reason:
        warn(f"{reason}; no vertex is moved: scale or flow smooth the mesh nevertheless")
    return Smoothed(**found)


def _positive(value: Any, name: str) -> float:
    """A finite number above 0."""
    found = _checks.number(value, name)
    if found <= 0:
        raise ValueError(f"{name} is {found}: a number above 0 is needed")
    return found


def _numbers(values: Any, name: str, known: bool = True) -> np.ndarray:
    """Numbers (n,) in double precision."""
    try:
        found = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name} has no numbers: one for each vertex is needed") from None
    if np.ma.isMaskedArray(values) or found.ndim != 1 or (known and not np.isfinite(found).all()):
        raise ValueError(f"{name} has to be one-dimensional, with finite numbers, one for each vertex")
    return found
