"""Makes arrays ready for the compiled module: one piece of memory, in a number type that it reads.

The compiled module calls these functions for whatever it cannot read in place.
"""

from __future__ import annotations

from typing import Any, List, Optional

import numpy as np

from . import _helfrich
from ._checks import number, shown
from ._errors import MeshError

READY: Any = ["C_CONTIGUOUS", "ALIGNED"]


def _array(given: Any, name: str) -> np.ndarray:
    _refuse_masked(given, name)
    if isinstance(given, (list, tuple)):
        for row in given:
            _refuse_masked(row, name)
    try:
        array = np.asarray(given)
    except Exception as error:
        raise MeshError(f"{name} is no array: {error}") from error
    if array.dtype.kind == "O":
        raise MeshError(
            f"{name} is {shown(given)}: an array of numbers is needed, or a mesh of pyvista, trimesh or "
            "meshio in the place of V and F"
        )
    return array


def _refuse_masked(given: Any, name: str) -> None:
    """Refuses entries that are masked: no surface has a hole in its numbers."""
    if not isinstance(given, np.ma.MaskedArray):
        return
    masked = np.argwhere(np.ma.getmaskarray(given))
    if len(masked):
        place = ", ".join(str(index) for index in masked[0])
        raise MeshError(
            f"{len(masked)} entries of {name} are masked, the first at [{place}]: leave these vertices and "
            f"their faces out, or take {name}.filled(...) with numbers for them"
        )


# Numbers of VTK's types of cells: polygons with straight edges, and those without area.
_POLYGONS = (5, 7, 9)
_WITHOUT_AREA = (0, 1, 2, 3, 4, 21)


def _one(mesh: Any) -> Any:
    """One mesh of several, as their own library joins them; everything else as it is given.

    All vertices are kept in their order, so that results at the vertices belong to them.
    """
    if hasattr(mesh, "n_blocks") and hasattr(mesh, "combine"):
        return mesh.combine()
    if hasattr(mesh, "geometry") and hasattr(mesh, "graph"):
        return mesh.to_geometry() if hasattr(mesh, "to_geometry") else mesh.dump(concatenate=True)
    if hasattr(mesh, "extract_surface") and not hasattr(mesh, "strips") and not hasattr(mesh, "celltypes"):
        kind = type(mesh).__name__
        raise MeshError(f"a {kind} is no surface of polygons: mesh.extract_surface().triangulate() is one")
    return mesh


def _mesh_points(mesh: Any) -> Any:
    """The positions of a mesh of another library; the object itself if it is none."""
    if isinstance(mesh, (np.ndarray, list, tuple)):
        return mesh
    mesh = _one(mesh)
    for name in ("points", "vertices"):
        if hasattr(mesh, name):
            return getattr(mesh, name)
    return mesh


def _mesh_faces(mesh: Any) -> Any:
    """The faces of a mesh of another library; the object itself if it is none."""
    if isinstance(mesh, (np.ndarray, list, tuple)):
        return mesh
    mesh = _one(mesh)
    if hasattr(mesh, "celltypes") and hasattr(mesh, "cell_connectivity"):
        return _grid_faces(mesh)
    if hasattr(mesh, "cells") and hasattr(mesh, "cells_dict") and hasattr(mesh, "points"):
        return _cell_faces(mesh)
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):
        return _listed_faces(mesh)
    for name in ("faces", "triangles"):
        if hasattr(mesh, name):
            return getattr(mesh, name)
    if hasattr(mesh, "points") or hasattr(mesh, "vertices"):
        raise MeshError(f"a {type(mesh).__name__} has points but no faces: a surface of triangles is needed")
    return mesh


def _listed_faces(mesh: Any) -> Any:
    """The triangles of pyvista, where numbers of corners stand before the corners."""
    strips = np.asarray(getattr(mesh, "strips", ()))
    if strips.size:
        raise MeshError("the mesh has triangle strips: mesh.triangulate() makes triangles of them")
    flat = np.asarray(mesh.faces)
    if flat.ndim == 2:
        return flat
    if flat.size % 4 != 0 or np.any(flat[::4] != 3):
        raise MeshError("the mesh has polygons: mesh.triangulate() makes triangles of them")
    return flat.reshape(-1, 4)[:, 1:]


def _grid_faces(mesh: Any) -> Any:
    """The triangles of an unstructured grid of pyvista, whose polygons are divided; cells without area are left out."""
    # pyvista 0.49 has another name for the ends of cells.
    ends = np.asarray(mesh.cell_offsets if hasattr(mesh, "cell_offsets") else mesh.offset)
    kinds = np.asarray(mesh.celltypes)
    corners = np.asarray(mesh.cell_connectivity).astype(np.int64)
    others = kinds[~np.isin(kinds, _POLYGONS + _WITHOUT_AREA)]
    if others.size:
        raise MeshError(
            f"the mesh has {others.size} cells that are no triangles, quads or polygons with straight edges, the first "
            f"of VTK's type {others[0]}: mesh.extract_surface().triangulate() is a surface"
        )
    kept = np.isin(kinds, _POLYGONS)
    if not kept.any():
        raise MeshError("the mesh has no triangles, quads or polygons: a surface is needed")
    sizes = np.diff(ends).astype(np.int64)
    corners, sizes = corners[np.repeat(kept, sizes)], sizes[kept]
    if (sizes == 3).all():
        return corners.reshape(-1, 3)
    return _helfrich.divided(positions(mesh.points), corners, sizes)


def _cell_faces(mesh: Any) -> Any:
    """The triangles of meshio, whose cells are blocks of one kind each; others with straight edges are divided.

    Points and lines are left out: they have no area. Everything else is refused.
    """
    triangles: List[np.ndarray] = []
    for block in mesh.cells:
        kind, cells = str(block.type), block.data
        if kind == "vertex" or kind.startswith(("line", "poly_vertex", "poly_line")) or not len(cells):
            continue
        if kind == "triangle":
            triangles.append(faces(cells, f"the block {kind!r}"))
        elif kind == "quad" or kind.startswith("polygon"):
            triangles.append(_divided(mesh.points, cells, kind))
        else:
            raise MeshError(
                f"the mesh has {len(cells)} cells of the kind {kind!r}: only triangles, quads and polygons with "
                "straight edges are a surface: remove the others, or extract their surface"
            )
    if not triangles:
        kinds = ", ".join(sorted({str(block.type) for block in mesh.cells})) or "none"
        raise MeshError(f"the mesh has no triangles, quads or polygons: its cells are {kinds}")
    return np.concatenate([part.astype(np.int64) for part in triangles])


def _divided(points: Any, cells: Any, kind: str) -> np.ndarray:
    """The triangles into which polygons are divided, as those of mesh files are."""
    polygons = [np.asarray(cell) for cell in cells]
    for place, corners in enumerate(polygons):
        if corners.dtype.kind not in "iu" or corners.ndim != 1:
            raise MeshError(f"cell {place} of the block {kind!r} is no list of vertices")
    sizes = np.array([len(corners) for corners in polygons], np.int64)
    return _helfrich.divided(positions(points), np.concatenate(polygons).astype(np.int64), sizes)


def positions(given: Any, name: str = "V") -> np.ndarray:
    """Positions (n, 3) as float32, if they are, or float64, in C order."""
    array = _array(_mesh_points(given), name)
    if array.dtype.kind not in "fiu":
        raise MeshError(f"{name} holds {array.dtype}: floating-point numbers are needed")
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"{name} has the shape {array.shape}: (n, 3) is needed")
    single = array.dtype.kind == "f" and array.dtype.itemsize == 4
    return np.require(array, np.float32 if single else np.float64, READY)


def faces(given: Any, name: str = "F") -> np.ndarray:
    """Faces (m, 3) as integers of their own size, in C order."""
    array = _array(_mesh_faces(given), name)
    if array.dtype.kind not in "iu":
        raise MeshError(
            f"{name} holds {array.dtype}: whole numbers of vertices are needed, of any integer type"
        )
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"{name} has the shape {array.shape}: (m, 3) is needed, one row a triangle")
    return np.require(array, array.dtype.newbyteorder("="), READY)


def numbers(given: Any, name: str) -> np.ndarray:
    """Numbers (n,) as float64."""
    if not isinstance(given, (list, tuple)) and np.ndim(given) == 0:
        # The compiled module has seen that it is none.
        return np.array([number(given, name)])
    array = _array(given, name)
    if array.dtype.kind not in "fiu" or array.ndim != 1:
        raise MeshError(
            f"{name} is {shown(given)}: a number is needed, or an array (n,) with one for each vertex or component"
        )
    return np.require(array, np.float64, READY)


def labels(given: Any, name: str) -> np.ndarray:
    """Whole numbers (n,) as int64."""
    array = _array(given, name)
    if array.dtype.kind not in "iu" or array.ndim != 1:
        raise MeshError(f"{name} is {shown(given)}: an array (n,) of whole numbers is needed")
    if array.size and array.max() > np.iinfo(np.int64).max:
        raise MeshError(f"{name} has {array.max()}: whole numbers of 63 bits are possible")
    return np.require(array, np.int64, READY)


def field(given: Any, name: str, vertices: int) -> np.ndarray:
    """A field at the vertices for a file, (n,) or (n, 3), as float64."""
    array = _array(given, name)
    if array.dtype.kind not in "fiub" or array.shape not in ((vertices,), (vertices, 3)):
        raise MeshError(
            f"{name} is {array.dtype} of the shape {array.shape}: numbers of the shape ({vertices},) or "
            f"({vertices}, 3) are needed"
        )
    return np.require(array, np.float64, READY)


def both(V: Any, F: Optional[Any]) -> tuple:
    """V and F; both of V if F is left out."""
    return (V, V) if F is None else (V, F)
