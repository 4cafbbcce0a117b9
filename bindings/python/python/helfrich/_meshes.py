"""Meshes: files, exact shapes, checks, refinement."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

from . import _checks, _helfrich
from ._arrays import both, faces as faces_of, field as field_of, positions
from ._errors import MeshError

Mesh = Tuple[np.ndarray, np.ndarray]


def read(path: "str | os.PathLike[str]") -> Mesh:
    """Reads a mesh file: OBJ, OFF, STL, PLY, VTP, VTU, VTK, glTF, MSH, GIFTI or 3MF, also compressed by gzip.

    Polygons become triangles. STL files are welded; others keep their vertices, see `weld`.

    Returns
    -------
    V : (n, 3) float64
        All digits of the file.
    F : (m, 3) uint32

    Raises
    ------
    OSError
        If the file cannot be read.
    MeshError
        If its content is no oriented manifold.

    Examples
    --------
    >>> import helfrich, tempfile, os
    >>> V, F, _ = helfrich.shape("sphere", 42)
    >>> path = os.path.join(tempfile.mkdtemp(), "sphere.ply")
    >>> helfrich.write(path, V, F)
    >>> bool((helfrich.read(path)[0] == V).all())
    True
    """
    return _helfrich.read(_checks.path(path, "path"))


def write(path: "str | os.PathLike[str]", V: Any, F: Any = None, **vertex_fields: Any) -> None:
    """Writes a mesh file, completely or not at all: OBJ, OFF, STL, PLY, VTP or GLB.

    All formats keep all digits of float64, except STL and GLB with those of float32. VTP files take fields at the
    vertices, (n,) or (n, 3), by keyword, for ParaView and pyvista.

    Raises
    ------
    OSError
        If the file cannot be written.
    MeshError
        If V and F are no mesh, or a field does not fit it.
    ValueError
        If the name has no known ending, or the format takes no fields.

    Examples
    --------
    >>> import helfrich, tempfile, os
    >>> V, F, exact = helfrich.shape("discocyte", 642)
    >>> path = os.path.join(tempfile.mkdtemp(), "cell.vtp")
    >>> helfrich.write(path, V, F, H=exact.H, normal=exact.normal)
    """
    V, F = both(V, F)
    path = _checks.path(path, "path")
    if vertex_fields and not path.lower().endswith(".vtp"):
        raise ValueError(f"{path}: fields are written to .vtp files only")
    vertices = len(positions(V))
    fields = {
        name: field_of(values, f"the field {_checks.text(name, 'the name of a field')}", vertices)
        for name, values in vertex_fields.items()
    }
    _helfrich.write(path, V, F, fields)


class Exact(NamedTuple):
    """Exact values at the vertices of a shape. Arrays are (n,) or (n, 3) float64."""

    H: np.ndarray
    """Mean curvature, 1/length."""
    K: np.ndarray
    """Gaussian curvature, 1/length²."""
    laplacian_of_H: np.ndarray
    """Δ_S H, 1/length³."""
    f: np.ndarray
    """The bending force density along the normal for κ = 1, 1/length³."""
    normal: np.ndarray
    """Outward unit normal (n, 3)."""
    area: float
    """Area of the shape."""
    volume: float
    """Volume of the shape."""


def shape(
    spec: str, n: int, *, family: str = "regular", seed: int = 0
) -> Tuple[np.ndarray, np.ndarray, Exact]:
    """A mesh on a shape whose curvatures are known exactly.

    Parameters
    ----------
    spec : str
        "sphere", "sphere:R", "ellipsoid:a,b,c", "torus:R,r" or "discocyte:R" (a red blood cell).
    n : int
        Number of vertices; 10·4^k + 2 for refined icosahedra. Tori have nearly as many.
    family : str
        "regular", "smooth", "relaxed", "irregular" or "hard" (with needles and caps).
    seed : int
        Seed of the families with random points.

    Returns
    -------
    V : (n, 3) float64
    F : (m, 3) uint32
    exact : Exact
        `H K laplacian_of_H f normal area volume`.

    Raises
    ------
    ValueError
        If there is no such shape, family or number of vertices, or its exact values are too large for float64.

    Examples
    --------
    >>> import helfrich
    >>> V, F, exact = helfrich.shape("torus:3,1", 600)
    >>> bool(exact.K.min() < 0 < exact.K.max())
    True
    """
    (V, F), exact = _helfrich.shape(
        _checks.text(spec, "spec"),
        _checks.whole(n, "n", 1, 2**32 - 1),
        _checks.text(family, "family"),
        _checks.whole(seed, "seed", 0, 2**64 - 1),
    )
    return V, F, Exact(**exact)


@dataclass(frozen=True)
class Problem:
    """Something that is wrong with a mesh, and where."""

    message: str
    face: Optional[int] = None
    edge: Optional[Tuple[int, int]] = None
    vertex: Optional[int] = None

    def __str__(self) -> str:
        return self.message


@dataclass(frozen=True)
class ComponentReport:
    """The measures of a connected component."""

    first_vertex: int
    vertices: int
    faces: int
    boundary_edges: int
    euler_characteristic: int
    genus: Optional[int]
    """Number of handles; None if there is a boundary."""
    area: float
    volume: Optional[float]
    """Enclosed volume; None if there is a boundary."""
    total_mean_curvature: float
    """∫ H dS, a length: 4πR on a sphere. Its ratio to the area is the mean of H."""


@dataclass(frozen=True)
class Report:
    """The result of `check`; numbers are 0 or None if the arrays are no mesh."""

    problems: List[Problem] = field(default_factory=list)
    """What is wrong; empty if nothing is."""
    is_mesh: bool = False
    """Whether the arrays are an oriented manifold, so that all functions take them."""
    vertices: int = 0
    faces: int = 0
    edges: int = 0
    boundary_edges: int = 0
    isolated_vertices: int = 0
    split_vertices: int = 0
    """Boundary vertices at the same point as others: `weld` merges them."""
    components: int = 0
    euler_characteristic: int = 0
    genus: Optional[int] = None
    """Sum of the handles of all components; None if there is a boundary."""
    area: float = 0.0
    volume: Optional[float] = None
    """Enclosed volume; None if there is a boundary."""
    angles: Tuple[float, float] = (0.0, 0.0)
    """Smallest and largest angle of a triangle, in degrees."""
    valences: Tuple[int, int] = (0, 0)
    """Fewest and most neighbours of a vertex."""
    edge_lengths: Tuple[float, float] = (0.0, 0.0)
    noise: float = 0.0
    """Noise of the positions along the normal, a length; 0 if none was found."""
    noise_in_edges: float = 0.0
    """The same over the mean edge length."""
    total_mean_curvature: float = 0.0
    """∫ H dS, a length: half the sum over edges of length times angle between the normals, 4πR on a sphere."""
    by_component: List[ComponentReport] = field(default_factory=list)
    """The measures of each component, in the order of their first vertices, as `split` returns them."""

    @property
    def quality(self) -> float:
        """The smallest angle over 60°: 1 for equilateral triangles, 0 for a degenerate one."""
        return self.angles[0] / 60.0


def check(V: Any, F: Any = None) -> Report:
    """Counts, topology, quality, noise and problems of a mesh. Never raises.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`, or anything else: what is wrong is told in `problems`.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("torus", 600)
    >>> report = helfrich.check(V, F)
    >>> report.genus, report.problems
    (1, [])
    >>> print(*helfrich.check(V, F[:, ::-1]).problems)
    the faces run clockwise seen from outside, and normals point inward: reverse them, as F[:, ::-1] does
    """
    try:
        V, F = both(V, F)
        found = _helfrich.inspect(V, F)
    except MeshError as error:
        return Report([Problem(str(error), error.face, error.edge, error.vertex)])
    except Exception as error:  # noqa: BLE001, never raises
        return Report([Problem(f"{type(error).__name__}: {error}")])
    problems = [
        Problem(f"face {face} has no area", face=face) for face in found.pop("degenerate_faces")
    ]
    if found["split_vertices"]:
        problems.append(
            Problem(f"{found['split_vertices']} vertices are at the same points as others: weld the mesh")
        )
    if found["isolated_vertices"]:
        problems.append(Problem(f"{found['isolated_vertices']} vertices are in no face"))
    if found["volume"] is not None and found["volume"] < 0:
        problems.append(
            Problem(
                "the faces run clockwise seen from outside, and normals point inward: reverse them, as "
                "F[:, ::-1] does"
            )
        )
    genus = None
    if found["boundary_edges"] == 0:
        genus = found["components"] - found["euler_characteristic"] // 2
    found["by_component"] = [ComponentReport(**measures) for measures in found["by_component"]]
    return Report(problems, True, genus=genus, **found)


@dataclass(frozen=True, repr=False)
class Part:
    """A connected component as a mesh of its own. It can be taken apart: `V, F = part`."""

    vertices: np.ndarray
    """Positions V (n, 3) float64."""
    faces: np.ndarray
    """Triangles F (m, 3) int64."""
    vertex_of: np.ndarray
    """The vertex in the whole mesh of each vertex, (n,) int64: `field[vertex_of]` is a field of the whole."""
    face_of: np.ndarray
    """The face in the whole mesh of each face, (m,) int64."""

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter((self.vertices, self.faces))

    def __repr__(self) -> str:
        return f"Part({len(self.vertices)} vertices, {len(self.faces)} faces)"


def split(V: Any, F: Any = None) -> List[Part]:
    """The connected components of a mesh, each as a mesh of its own.

    Vertices and faces keep their order, and components have that of their first vertices. Vertices in no face are
    left out.

    Returns
    -------
    list of Part
        `vertices faces vertex_of face_of`.

    Raises
    ------
    MeshError
        If V and F are no mesh.

    Examples
    --------
    >>> import helfrich, numpy
    >>> V, F, _ = helfrich.shape("sphere", 42)
    >>> one, two = helfrich.split(numpy.vstack([V, V + 3]), numpy.vstack([F, F + 42]))
    >>> bool((two.vertices == V + 3).all())
    True
    """
    V, F = both(V, F)
    component = _helfrich.components(V, F)
    V, F = np.asarray(positions(V), np.float64), faces_of(F).astype(np.int64)
    # Stable sorts keep the order within a component.
    vertices, faces = np.argsort(component, kind="stable"), np.argsort(component[F[:, 0]], kind="stable")
    counts = np.bincount(component)
    ends = np.cumsum(counts)
    number = np.empty_like(component)
    number[vertices] = np.arange(len(V)) - np.repeat(ends - counts, counts)
    face_ends = np.cumsum(np.bincount(component[F[:, 0]], minlength=len(counts)))
    parts = zip(np.split(vertices, ends[:-1]), np.split(faces, face_ends[:-1]))
    return [Part(V[own], number[F[of]], own, of) for own, of in parts if len(of)]


def weld(
    V: Any, F: Any = None, *, distance: float = 0.0
) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Merges vertices at the same point, or at most `distance` apart.

    A vertex becomes the nearest one before it that was kept; triangles of which two corners are merged are
    left out.

    Returns
    -------
    V : (k, 3) float64
    F : (m, 3) uint32
    map : (n,) uint32
        The new vertex of each old one.

    Raises
    ------
    MeshError
        If the result is no oriented manifold, or a position is not finite.
    ValueError
        If the distance is negative or not finite.

    Examples
    --------
    >>> import helfrich, numpy
    >>> V, F, _ = helfrich.shape("sphere", 42)
    >>> soup = numpy.arange(F.size).reshape(-1, 3)
    >>> merged, faces, where = helfrich.weld(V[F.ravel()], soup)
    >>> len(V[F.ravel()]), len(merged)
    (240, 42)
    """
    V, F = both(V, F)
    (V, F), where = _helfrich.weld(V, F, _checks.length(distance, "distance"))
    return V, F, where


@dataclass(frozen=True, repr=False)
class Repaired:
    """A mesh made by `repair`, and what was changed. It can be taken apart: `V, F = repaired`."""

    vertices: np.ndarray
    """Positions V (n, 3) float64."""
    faces: np.ndarray
    """Triangles F (m, 3) uint32."""
    vertex_of: np.ndarray
    """The vertex before the repair of each vertex, (n,) int64: `field[vertex_of]` carries a field over."""
    face_of: np.ndarray
    """The face before the repair of each face, (m,) int64; -1 where it fills a hole."""
    actions: Dict[str, int]
    """The changes with their numbers, such as {"bow_ties": 3}; empty if the mesh is the same. The guide to repair
    has their names."""
    holes_left: int
    """Holes within the requested size that could not be filled."""
    slivers_left: int
    """Triangles with an angle below the requested one that could not be removed."""
    text: str
    """A line for each change."""

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter((self.vertices, self.faces))

    def __repr__(self) -> str:
        lines = self.text.splitlines() or ["nothing was changed"]
        size = f"{len(self.vertices)} vertices, {len(self.faces)} faces"
        return f"Repaired({size}; {'; '.join(lines)})"


def repair(
    V: Any,
    F: Any = None,
    *,
    weld: Optional[float] = None,
    sheets: str = "split",
    fill: int = 0,
    slivers: float = 0.0,
    outward: bool = False,
    drop_unused: bool = False,
) -> Repaired:
    """Makes a mesh of triangles that are none, and says what was changed.

    Repeated corners, duplicates, edges with three or more triangles, contradicting orientations, surfaces with one
    side, and vertices where surfaces only touch are always repaired, and faces with positions that are not finite
    left out. A valid mesh keeps every bit, and a second repair finds nothing.

    Parameters
    ----------
    V, F
        Positions and triangles, as in `curvature`, that need not form a mesh; or the path of a mesh file, as V
        without F.
    weld : float, optional
        Merges vertices at most this far apart, with 0 those at the same point.
    sheets : str
        Sheets that are kept at edges with three or more triangles: "split" keeps all, "largest" the one with the
        largest area.
    fill : int
        Fills holes with at most this number of edges.
    slivers : float
        Removes triangles with an angle below this one, in degrees from 0 to 60.
    outward : bool
        Turns closed components that are inside out, also where they are valid.
    drop_unused : bool
        Leaves out vertices that no triangle had before.

    Returns
    -------
    Repaired
        `vertices faces vertex_of face_of actions holes_left slivers_left`.

    Raises
    ------
    MeshError
        If no triangle is left, or one names a vertex that does not exist.
    OSError
        If the file cannot be read.
    ValueError
        If another argument is out of its range.

    Examples
    --------
    >>> import helfrich, numpy
    >>> V, F, _ = helfrich.shape("sphere", 42)
    >>> broken = numpy.vstack([F, F[:1], [[3, 3, 4]]])
    >>> repaired = helfrich.repair(V, broken)
    >>> repaired.actions
    {'repeated': 1, 'duplicates': 1}
    >>> V, F = repaired
    >>> helfrich.check(V, F).genus
    0
    """
    settings: Dict[str, Any] = dict(
        weld=None if weld is None else _checks.length(weld, "weld"),
        sheets=_checks.text(sheets, "sheets"),
        fill=_checks.whole(fill, "fill", 0, 2**32 - 1),
        slivers=_checks.length(slivers, "slivers"),
        outward=_checks.flag(outward, "outward"),
        drop_unused=_checks.flag(drop_unused, "drop_unused"),
    )
    if settings["slivers"] > 60:
        raise ValueError(f"slivers is {slivers}, above 60, the largest that the smallest angle of a triangle can be")
    if F is None and isinstance(V, (str, bytes, os.PathLike)):
        found = _helfrich.repair_file(_checks.path(V, "V"), **settings)
    else:
        V, F = both(V, F)
        found = _helfrich.repair(V, F, **settings)
    mesh, origins, actions, left = found
    return Repaired(*mesh, *origins, dict(actions), *left)


def subdivide(V: Any, F: Any = None, *, levels: int = 1, limit: bool = False) -> Mesh:
    """Refines a mesh by Loop's rules: four triangles for each triangle and level.

    With `limit`, vertices are placed on the smooth surface to which further refinement would converge.

    Returns
    -------
    V : (k, 3) float64
        The vertices of the mesh come first, in their order.
    F : (4^levels m, 3) uint32

    Raises
    ------
    MeshError
        If V and F are no mesh, or the result is too large.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("sphere", 42)
    >>> helfrich.subdivide(V, F, levels=2)[0].shape
    (642, 3)
    """
    V, F = both(V, F)
    return _helfrich.subdivide(V, F, _checks.whole(levels, "levels", 0, 32), _checks.flag(limit, "limit"))
