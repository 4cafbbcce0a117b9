"""Operators as sparse matrices of SciPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Tuple

import numpy as np

from . import _checks, _helfrich
from ._arrays import both

if TYPE_CHECKING:
    from scipy.sparse import csr_array


def _sparse() -> Any:
    try:
        import scipy.sparse
    except ImportError as error:
        raise ImportError("sparse matrices need SciPy: pip install scipy") from error
    return scipy.sparse


def laplacian(
    V: Any, F: Any = None, *, method: str = "cotangent", mass: str = "mixed"
) -> Tuple["csr_array", "csr_array"]:
    """The negative Laplacian L, positive semidefinite, and the mass matrix M.

    The sign is that of potpourri3d and robust_laplacian, and the opposite of libigl's: M⁻¹ L u is
    −Δ u. By default L is symmetric to the last bit, its rows sum to 0, and u·L u is ∫ |∇u|² dS.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`. Boundaries are free: nothing flows through them.
    method : str
        "cotangent" is that of linear finite elements. The operators of methods in strong form are
        "meyer", "belkin", "farutin", "j4", "j6", "j8" and "jet": L is −M Δ then, and neither symmetric nor
        semidefinite, but jets converge at every vertex.
    mass : str
        For "cotangent", the areas on the diagonal of M: "mixed", those of the cotangent curvatures, "barycentric",
        thirds of triangles, or "voronoi". "consistent" is the mass matrix of linear finite elements.

    Returns
    -------
    L, M : scipy.sparse.csr_array, (n, n) float64
        L is dimensionless, M is in length².

    Raises
    ------
    MeshError
        If V and F are no mesh.
    ValueError
        If the method or the mass is unknown.
    ImportError
        If SciPy is missing.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("sphere", 642)
    >>> L, M = helfrich.laplacian(V, F)
    >>> x = V[:, 0]  # An eigenfunction: −Δ x = 2 x on the unit sphere.
    >>> round(float(x @ L @ x / (x @ M @ x)), 1)
    2.0
    """
    sparse = _sparse()
    V, F = both(V, F)
    method, mass = _checks.text(method, "method"), _checks.text(mass, "mass")
    consistent, areas = None, None
    if method == "cotangent":
        matrix, areas, consistent = _helfrich.stiffness(V, F, mass)
    else:
        (values, columns, offsets), areas, _ = _helfrich.laplacian(V, F, method)
        matrix = values * -np.repeat(areas, np.diff(offsets)), columns, offsets
    n = len(matrix[2]) - 1
    L = sparse.csr_array(matrix, shape=(n, n))
    if consistent is not None:
        return L, sparse.csr_array(consistent, shape=(n, n))
    diagonal = np.arange(n + 1)
    return L, sparse.csr_array((areas, diagonal[:-1], diagonal), shape=(n, n))


def gradient(V: Any, F: Any = None) -> "csr_array":
    """The gradient G (3 m, n) of fields that are linear in each triangle.

    `(G @ u).reshape(-1, 3)` is ∇u of each triangle, tangential to it, in the unit of u over length:
    rows 3 t, 3 t + 1 and 3 t + 2 are the components in triangle t. That is another order of rows than
    libigl's, which has all x first.

    Raises
    ------
    MeshError
        If V and F are no mesh.
    ImportError
        If SciPy is missing.

    Examples
    --------
    >>> import helfrich
    >>> V, F = [[0, 0, 0], [2, 0, 0], [0, 1, 0]], [[0, 1, 2]]
    >>> (helfrich.gradient(V, F) @ [0.0, 2.0, 0.0]).tolist()
    [1.0, 0.0, 0.0]
    """
    sparse = _sparse()
    V, F = both(V, F)
    values = _helfrich.gradient(V, F)
    from ._arrays import faces, positions

    columns = np.repeat(faces(F).astype(np.int64), 3, axis=0)
    offsets = np.arange(0, values.size + 1, 3)
    shape = (len(values), len(positions(V)))
    return sparse.csr_array((values.ravel(), columns.ravel(), offsets), shape=shape)
