"""Curvatures at every vertex."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Optional, overload

import numpy as np

from . import _checks, _helfrich
from ._arrays import both

class Flag(enum.IntFlag):
    """Reasons why values at a vertex are less trustworthy than usual.

    The first are findings of methods, which also concern the neighbours of a vertex. The last three, and
    UNRESOLVED, are verdicts of jets that choose their scale.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("sphere", 162)
    >>> found = helfrich.curvature(V, F[1:])  # A hole, of one face.
    >>> one_sided = found.flags & helfrich.Flag.ONE_SIDED != 0
    >>> bool(one_sided[F[0]].all())
    True
    """

    ZERO_AREA = 1 << 0
    """The vertex has no area, and was left out."""
    NEGATIVE_AREA = 1 << 1
    """Its area is negative, and was used as it is."""
    REDUCED_DEGREE = 1 << 2
    """Its neighbours determine only a fit of lower degree."""
    TOO_FEW_NEIGHBOURS = 1 << 3
    """Its neighbours determine no fit: it was left out."""
    SMALL_AREA = 1 << 4
    """Its area all but cancels."""
    CLAMPED_AREA = 1 << 5
    """Its area was not positive, and was replaced by a mixed one."""
    AMPLIFIED = 1 << 6
    """Its neighbours hardly determine the fit."""
    UNEVEN = 1 << 7
    """Its edges have very different lengths."""
    UNUSUAL_VALENCE = 1 << 8
    """It has fewer than four or more than nine neighbours."""
    FOLDED = 1 << 9
    """The surface folds back there."""
    ROUNDED_POSITION = 1 << 10
    """Its position has too few digits for a fourth derivative."""
    NOISY_POSITION = 1 << 11
    """A fourth derivative is lost in noise there."""
    OUT_OF_RANGE = 1 << 12
    """Its triangles are too small for a fourth derivative."""
    OVERSTRETCHED = 1 << 13
    """A triangle is stretched beyond what numbers hold."""
    DEGENERATE_TRIANGLE = 1 << 14
    """A triangle has no area."""
    THIN_TRIANGLE = 1 << 15
    """A triangle is very thin."""
    NO_GRAPH = 1 << 16
    """The fit around it is no graph over its triangles."""
    UNRESOLVED = 1 << 17
    """The mesh is too coarse for its shape there."""
    ROWS = 1 << 18
    """Its neighbours lie in rows and do not determine the fit: remesh the surface."""
    CREASE = 1 << 19
    """It is at a crease, corner or tip, where curvatures are not defined."""
    OUTLIER = 1 << 20
    """It lies far off the surface of its neighbours."""
    SMALL_COMPONENT = 1 << 21
    """Its component has too few vertices to tell errors."""
    GRID = 1 << 22
    """It is on an edge of a grid: ripples of a mask cannot be told from the shape, and error bars include both."""
    NOISE = 1 << 24
    """There is noise, to which error bars are fitted."""
    ONE_SIDED = 1 << 25
    """It is at a boundary or next to it: error bars are wider."""
    UNKNOWN = 1 << 26
    """There is no value, and it is 0; or no error bar, and it is infinite."""


class Errors(NamedTuple):
    """Error bars (n,): the true error is estimated to be within them at 99 of 100 vertices.

    They are infinite where nothing is known. `f` is that of the force density for κ = 1.
    """

    H: np.ndarray
    K: np.ndarray
    k1: np.ndarray
    k2: np.ndarray
    f: np.ndarray
    curvedness: np.ndarray
    shape_index: np.ndarray


class Curvature(NamedTuple):
    """The result of `curvature`. Arrays are (n,) or (n, 3), with the number type of V."""

    H: np.ndarray
    """Mean curvature (k1 + k2)/2, 1/length, positive on a sphere."""
    K: Optional[np.ndarray]
    """Gaussian curvature k1 k2, 1/length²; None if the method does not define it."""
    k1: Optional[np.ndarray]
    """The larger principal curvature; None if the method does not define K."""
    k2: Optional[np.ndarray]
    """The smaller principal curvature; None if the method does not define K."""
    curvedness: Optional[np.ndarray]
    """Curvedness √((k1² + k2²)/2), 1/length; None if the method does not define K."""
    shape_index: Optional[np.ndarray]
    """Shape index (2/π) arctan((k1 + k2)/(k1 − k2)) of Koenderink and van Doorn (1992): 1 on a sphere, ½ on a
    cylinder, 0 on a minimal surface, −1 on a sphere seen from inside. Where k1 = k2 = 0 there is none, and it is 0;
    its error bar is infinite where a plane is within those of k1 and k2. None if the method does not define K."""
    d1: Optional[np.ndarray]
    """Unit vector (n, 3) along k1, 0 near umbilics; None unless asked for."""
    d2: Optional[np.ndarray]
    """Unit vector (n, 3) along k2, 0 near umbilics; None unless asked for."""
    normal: np.ndarray
    """Outward unit normal (n, 3)."""
    area: np.ndarray
    """Mixed area of the vertex, length²."""
    error: Optional[Errors]
    """Error bars; None unless the method has them or they were asked for."""
    flags: np.ndarray
    """Sums of `helfrich.Flag`, uint32; 0 where nothing is wrong."""


def _answer(
    V: Any,
    F: Any,
    *,
    method: str = "auto",
    areas: Optional[str] = None,
    bandwidth: Any = None,
    kappa: Any = 1.0,
    H0: Any = 0.0,
    scale: Optional[int] = None,
    radius: Optional[float] = None,
    sigma: float = 0.0,
    errors: bool = False,
    force: bool = False,
    threads: Optional[int] = None,
) -> dict:
    V, F = both(V, F)
    if scale is not None and radius is not None:
        raise ValueError("scale and radius both give the extent of fits: leave one of them out")
    return _helfrich.curvature(
        V,
        F,
        method=_checks.text(method, "method"),
        areas=_checks.option(areas, "areas"),
        bandwidth=_checks.option(bandwidth, "bandwidth"),
        modulus=kappa,
        spontaneous_curvature=H0,
        scale=None if scale is None else _checks.whole(scale, "scale", 28, 4096),
        radius=None if radius is None else _checks.positive_length(radius, "radius"),
        sigma=_checks.length(sigma, "sigma"),
        errors=_checks.flag(errors, "errors"),
        force=force,
        threads=_checks.threads(threads),
    )


if TYPE_CHECKING:

    class _WithErrors(Curvature):
        error: Errors

    class _OfJets(_WithErrors):
        K: np.ndarray
        k1: np.ndarray
        k2: np.ndarray
        curvedness: np.ndarray
        shape_index: np.ndarray

    class _WithDirections(_OfJets):
        d1: np.ndarray
        d2: np.ndarray

    _Jets = Literal["auto", "jet", "J"]


# What is always there, for programs that check types: "auto" has error bars and all curvatures.
@overload
def curvature(
    V: Any,
    F: Any = None,
    *,
    method: _Jets = "auto",
    scale: Optional[int] = None,
    radius: Optional[float] = None,
    sigma: float = 0.0,
    directions: Literal[True],
    errors: bool = False,
    areas: Optional[str] = None,
    bandwidth: Any = None,
    threads: Optional[int] = None,
) -> _WithDirections: ...


@overload
def curvature(
    V: Any,
    F: Any = None,
    *,
    method: _Jets = "auto",
    scale: Optional[int] = None,
    radius: Optional[float] = None,
    sigma: float = 0.0,
    directions: bool = False,
    errors: bool = False,
    areas: Optional[str] = None,
    bandwidth: Any = None,
    threads: Optional[int] = None,
) -> _OfJets: ...


@overload
def curvature(
    V: Any,
    F: Any = None,
    *,
    method: str,
    scale: Optional[int] = None,
    radius: Optional[float] = None,
    sigma: float = 0.0,
    directions: bool = False,
    errors: Literal[True],
    areas: Optional[str] = None,
    bandwidth: Any = None,
    threads: Optional[int] = None,
) -> _WithErrors: ...


@overload
def curvature(
    V: Any,
    F: Any = None,
    *,
    method: str,
    scale: Optional[int] = None,
    radius: Optional[float] = None,
    sigma: float = 0.0,
    directions: bool = False,
    errors: bool = False,
    areas: Optional[str] = None,
    bandwidth: Any = None,
    threads: Optional[int] = None,
) -> Curvature: ...


def curvature(
    V: Any,
    F: Any = None,
    *,
    method: str = "auto",
    scale: Optional[int] = None,
    radius: Optional[float] = None,
    sigma: float = 0.0,
    directions: bool = False,
    errors: bool = False,
    areas: Optional[str] = None,
    bandwidth: Any = None,
    threads: Optional[int] = None,
) -> Curvature:
    """Curvatures, normals and areas at every vertex, with error bars.

    Parameters
    ----------
    V : (n, 3) float32 or float64
        Positions, read without a copy where they are in C order. A mesh of pyvista, trimesh or
        meshio may take the place of V and F.
    F : (m, 3) integers
        Triangles, counter-clockwise seen from outside.
    method : str
        "auto" fits osculating jets whose degree and number of neighbours follow from the noise at
        each vertex, and has error bars. Other methods are listed in `helfrich.METHODS`.
    scale : int, optional
        Number of neighbours of the fits of "auto", 28 to 4096, instead of their own choice.
    radius : float, optional
        Radius of the fits of "auto" instead, a length: they take all vertices within it, 28 to 4096 of them.
    sigma : float
        Known standard deviation of the positions along the normal, a length: a lower bound of the
        noise that "auto" assumes.
    directions : bool
        Whether principal directions are returned; only "auto" and `errors=True` know them.
    errors : bool
        Error bars for another method than "auto", by comparison with it.
    areas, bandwidth : str, optional
        Options of the methods that have them, as in the program.
    threads : int, optional
        Number of threads, all by default. Results do not depend on it.

    Returns
    -------
    Curvature
        `H K k1 k2 curvedness shape_index d1 d2 normal area error flags`. Values are never NaN: where one is unknown, it is
        0 and flagged `Flag.UNKNOWN`.

    Raises
    ------
    MeshError
        If V and F are no oriented manifold with finite coordinates.
    ValueError
        If there is no such method, or it does not define H.

    Examples
    --------
    >>> import helfrich
    >>> V, F, exact = helfrich.shape("sphere:2", 642)
    >>> c = helfrich.curvature(V, F)
    >>> bool((abs(c.H - 0.5) <= c.error.H).all())
    True
    """
    directions = _checks.flag(directions, "directions")
    found = _answer(
        V, F, method=method, areas=areas, bandwidth=bandwidth,
        scale=scale, radius=radius, sigma=sigma, errors=errors, threads=threads,
    )  # fmt: skip
    if found["H"] is None:
        raise ValueError(f"{method} defines no curvatures: choose a method that defines H, such as auto")
    if directions and "d1" not in found:
        raise ValueError(f"{method} has no principal directions: choose auto, or errors=True")
    bars = None
    if found["H_error"] is not None:
        bars = Errors(*(found[f"{name}_error"] for name in Errors._fields))
    return Curvature(
        H=found["H"],
        K=found["K"],
        k1=found.get("k1"),
        k2=found.get("k2"),
        curvedness=found.get("curvedness"),
        shape_index=found.get("shape_index"),
        d1=found["d1"] if directions else None,
        d2=found["d2"] if directions else None,
        normal=found["normal"],
        area=found["area"],
        error=bars,
        flags=found["flags"],
    )


def mean_curvature(V: Any, F: Any = None, *, method: str = "auto", threads: Optional[int] = None) -> np.ndarray:
    """Mean curvature H (n,), 1/length, positive on a sphere.

    Arguments and errors are those of `curvature`; H is 0 where it is unknown.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("sphere:2", 642)
    >>> float(helfrich.mean_curvature(V, F).max().round(3))
    0.5
    """
    return curvature(V, F, method=method, threads=threads).H


def gaussian_curvature(
    V: Any, F: Any = None, *, method: str = "auto", threads: Optional[int] = None
) -> np.ndarray:
    """Gaussian curvature K (n,), 1/length².

    Arguments and errors are those of `curvature`; also a ValueError if the method does not define K.
    K is 0 where it is unknown.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("sphere:2", 642)
    >>> float(helfrich.gaussian_curvature(V, F).max().round(3))
    0.25
    """
    found = curvature(V, F, method=method, threads=threads).K
    if found is None:
        raise ValueError(f"{method} does not define K: choose a method that does, such as auto")
    return found
