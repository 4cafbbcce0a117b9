"""Diffusion on a mesh: distances along the surface, and the flow of a surface to a sphere."""

from __future__ import annotations

from typing import Any, Callable, Tuple

import numpy as np

from . import _checks, _helfrich
from ._arrays import both, faces, labels, positions
from ._errors import MeshError
from ._operators import _sparse, gradient, laplacian


def _solver(matrix: Any) -> Callable[[np.ndarray], np.ndarray]:
    """Solves systems with a sparse matrix that is symmetric and positive definite."""
    from scipy.sparse.linalg import splu

    # Without a choice of pivots, in an order for symmetric patterns, which has the least fill.
    options = {"SymmetricMode": True}
    try:
        return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options).solve
    except RuntimeError as error:
        raise MeshError(f"triangles without area cut the surface into parts ({error}): repair the mesh") from error


def _areas(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """The areas of triangles (m,)."""
    a, b, c = (V[F[:, corner]] for corner in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def _prepared(V: Any, F: Any) -> Tuple[Any, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The stiffness matrix, the areas of vertices, positions as float64, faces, and components of vertices."""
    L, M = laplacian(V, F)
    component = _helfrich.components(V, F)
    V, F, mass = positions(V).astype(np.float64), faces(F).astype(np.int64), M.diagonal()
    flat = np.setdiff1d(F, np.flatnonzero(mass > 0))
    if len(flat):
        raise MeshError(
            f"{len(flat)} vertices have triangles without area only, the first is {flat[0]}: "
            "helfrich.repair(V, F, slivers=1) removes them",
            vertex=int(flat[0]),
        )
    return L, mass, V, F, component


def _border(F: np.ndarray, n: int) -> np.ndarray:
    """Whether vertices are at a boundary, (n,)."""
    edges = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    edges, counts = np.unique(edges, axis=0, return_counts=True)
    border = np.zeros(n, bool)
    border[edges[counts == 1]] = True
    return border


def _vertices(given: Any, n: int) -> np.ndarray:
    """The vertices from which distances are measured."""
    vertices = labels([given] if np.ndim(given) == 0 else given, "sources")
    if not len(vertices) or not (0 <= vertices.min() and vertices.max() < n):
        raise ValueError(f"sources is {_checks.shown(given)}: one vertex or more from 0 to {n - 1} are needed")
    return vertices


def geodesic_distance(V: Any, F: Any = None, *, sources: Any) -> np.ndarray:
    """Distances (n,) along the surface to the nearest of some vertices, by the heat method.

    K. Crane, C. Weischedel and M. Wardetzky, ACM Trans. Graph. 32 (2013) 152: heat flows from the sources for
    the time h², h the mean edge of their component, and the distance φ is the field whose gradient has the
    direction of the flow and the length 1: min ∫ |∇φ + ∇u/|∇u||² dS, with φ = 0 at the sources. On open surfaces u
    is the mean of the solutions with insulated and with cold boundaries. Where a component is so wide that heat
    does not reach all of it in double precision, its time is longer.

    On spheres of 642 to 10 242 vertices, errors are up to half a mean edge on even meshes with one source, and up to
    two on irregular meshes, or with several sources.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`.
    sources : int or (k,) integers
        Vertices with the distance 0.

    Returns
    -------
    (n,) float64
        Lengths; infinite in components without a source.

    Raises
    ------
    MeshError
        If V and F are no mesh, or sources are no whole numbers.
    ValueError
        If there is no source, or no such vertex.
    ImportError
        If SciPy is missing.

    Examples
    --------
    >>> import helfrich, numpy
    >>> V, F, _ = helfrich.shape("sphere", 2562)
    >>> d = helfrich.geodesic_distance(V, F, sources=0)
    >>> bool(abs(d - numpy.arccos(V @ V[0])).max() < 0.05)
    True
    """
    sparse = _sparse()
    V, F = both(V, F)
    G = gradient(V, F)
    L, mass, V, F, component = _prepared(V, F)
    sources = _vertices(sources, len(V))
    # Isolated vertices have no neighbours, and other components no heat.
    heated = np.isin(component, component[sources]) & (mass > 0)
    distance = np.full(len(V), np.inf)
    distance[sources] = 0.0
    free = heated & np.isinf(distance)
    areas, parts = _areas(V, F), component.max() + 1
    of_faces = component[F[:, 0]]
    # The square of the edge of equilateral triangles of the mean area.
    triangles = np.maximum(np.bincount(of_faces, minlength=parts), 1)
    time = (4 / np.sqrt(3) * np.bincount(of_faces, areas, parts) / triangles)[component]

    def temperature(inside: np.ndarray) -> np.ndarray:
        """The heat that is left of a unit at each source, per area and in units without length."""
        u = np.zeros(len(V))
        if inside.any():
            capacity = (mass[inside] / time[inside]) * np.where(distance[inside] == 0, 1.0, 0.0)
            u[inside] = _solver(sparse.diags_array(mass[inside] / time[inside]) + L[inside][:, inside])(capacity)
        return u

    u = temperature(heated)
    while heated.any() and abs(u[heated]).min() < np.finfo(float).tiny:
        time *= 4
        u = temperature(heated)
    border = _border(F, len(V))
    if border[heated].any():
        u = (u + temperature(heated & ~border)) / 2
    flow = -(G @ u).reshape(-1, 3)
    # Far away, squares of the flow are too small for numbers.
    largest = abs(flow).max(axis=1, keepdims=True)
    flow /= np.where(largest > 0, largest, 1.0)
    norm = np.linalg.norm(flow, axis=1, keepdims=True)
    flow *= areas[:, None] / np.where(norm > 0, norm, 1.0)
    if free.any():
        distance[free] = _solver(L[free][:, free])((G.T @ flow.ravel())[free])
    return distance


def conformal_flow(V: Any, F: Any = None, *, steps: int = 20, time: float = 0.1) -> np.ndarray:
    """Positions after conformalised mean curvature flow: a surface of genus 0 becomes a sphere.

    M. Kazhdan, J. Solomon and M. Ben-Chen, Comput. Graph. Forum 31 (2012) 1745: the flow ∂x/∂t = Δx with the
    Laplacian of the metric that is conformal to the first one, in implicit steps (M + τ L) x' = M x, with L of the
    given mesh and M the areas of vertices at x. Each component keeps its centre and its area. The map from the given
    mesh to the result is conformal: its angles are those of the surface up to errors of the first order in the
    edges.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`: components without boundary and handles. On others triangles degenerate.
    steps : int
        Number of steps. By default cells and ellipsoids become spheres with radii that differ by a few thousandths.
    time : float
        τ over the area of the component: the duration of a step.

    Returns
    -------
    (n, 3) float64
        The positions after the last step.

    Raises
    ------
    MeshError
        If V and F are no mesh, or a component has a boundary or handles.
    ValueError
        If steps or time are out of range, or a component collapses.
    ImportError
        If SciPy is missing.

    Examples
    --------
    >>> import helfrich, numpy
    >>> V, F, _ = helfrich.shape("ellipsoid:1,0.8,0.5", 642)
    >>> radius = numpy.linalg.norm(helfrich.conformal_flow(V, F), axis=1)
    >>> bool(numpy.ptp(radius) < 0.02 * radius.mean())
    True
    """
    sparse = _sparse()
    V, F = both(V, F)
    steps, time = _checks.whole(steps, "steps", 0, 2**32 - 1), _checks.length(time, "time")
    L, mass, x, F, component = _prepared(V, F)
    of_faces, parts = component[F[:, 0]], component.max() + 1
    moving = mass > 0  # Isolated vertices stay where they are.
    border = np.flatnonzero(_border(F, len(x)))
    # Vertices − edges + faces of a component without boundary; 2 without handles.
    euler = np.bincount(component, moving, parts) - np.bincount(of_faces, minlength=parts) / 2
    wrong = border if len(border) else np.flatnonzero(moving & (euler[component] != 2))
    if len(wrong):
        what = "a boundary" if len(border) else "handles"
        raise MeshError(
            f"the component of vertex {wrong[0]} has {what}: the flow is for closed surfaces of genus 0",
            vertex=int(wrong[0]),
        )

    def measured(x: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Areas of triangles and of components, and the centres of these."""
        areas = _areas(x, F)
        moments = areas[:, None] * x[F].mean(axis=1)
        whole = np.bincount(of_faces, areas, parts)
        centres = [np.bincount(of_faces, moments[:, axis], parts) for axis in range(3)]
        return areas, whole, np.stack(centres, axis=1) / np.where(whole > 0, whole, 1.0)[:, None]

    areas, first, centres = measured(x)
    own = component[moving]
    L = L[moving][:, moving]
    for step in range(steps):
        mass = np.bincount(F.ravel(), np.repeat(areas / 3, 3), len(x))[moving] / first[own]
        x[moving] = _solver(sparse.diags_array(mass) + time * L)(mass[:, None] * x[moving])
        areas, whole, shifted = measured(x)
        if not (np.isfinite(whole) & (whole > 0))[own].all():
            raise ValueError(f"a component collapsed in step {step + 1} of {steps}: take fewer, or a smaller time")
        scale = np.sqrt(first[own] / whole[own])[:, None]
        x[moving] = (x[moving] - shifted[own]) * scale + centres[own]
        areas = _areas(x, F)
    return x
