"""Makes arrays ready for the compiled module: one piece of memory, in a number type that it reads.

The compiled module calls these functions for whatever it cannot read in place.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ._errors import MeshError

READY: Any = ["C_CONTIGUOUS", "ALIGNED"]


def _array(given: Any, name: str) -> np.ndarray:
    try:
        return np.asarray(given)
    except Exception as error:
        raise MeshError(f"{name} is no array: {error}") from error


def _mesh_points(mesh: Any) -> Any:
    """The positions of a mesh of another library; the object itself if it is none."""
    if isinstance(mesh, (np.ndarray, list, tuple)):
        return mesh
    for name in ("points", "vertices"):
        if hasattr(mesh, name):
            return getattr(mesh, name)
    return mesh


def _mesh_faces(mesh: Any) -> Any:
    """The faces of a mesh of another library; the object itself if it is none."""
    if isinstance(mesh, (np.ndarray, list, tuple)):
        return mesh
    if hasattr(mesh, "cells_dict") and hasattr(mesh, "points") and not hasattr(mesh, "faces"):
        cells = mesh.cells_dict
        if isinstance(cells, dict) and "triangle" in cells:
            return cells["triangle"]
        raise MeshError("the mesh has no triangles among its cells: extract and triangulate its surface")
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):
        flat = np.asarray(mesh.faces)
        if flat.ndim == 2:
            return flat
        if flat.size % 4 != 0 or np.any(flat[::4] != 3):
            raise MeshError("the mesh has polygons: mesh.triangulate() makes triangles of them")
        return flat.reshape(-1, 4)[:, 1:]
    for name in ("faces", "triangles"):
        if hasattr(mesh, name):
            return getattr(mesh, name)
    return mesh


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
    array = _array(given, name)
    if array.dtype.kind not in "fiu" or array.ndim != 1:
        raise MeshError(f"{name} is no number, and no array (n,) of numbers")
    return np.require(array, np.float64, READY)


def labels(given: Any, name: str) -> np.ndarray:
    """Whole numbers (n,) as int64."""
    array = _array(given, name)
    if array.dtype.kind not in "iu" or array.ndim != 1:
        raise MeshError(f"{name} is no array (n,) of whole numbers")
    return np.require(array, np.int64, READY)


def both(V: Any, F: Any) -> tuple:
    """V and F; both of V if F is left out."""
    return (V, V) if F is None else (V, F)
