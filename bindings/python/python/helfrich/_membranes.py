"""Energies and forces."""

from __future__ import annotations

from typing import Any, Dict, Optional

import numpy as np

from . import _checks, _helfrich
from ._arrays import both, positions
from ._curvatures import _answer
from ._helfrich import Membrane
from .effects import Bending

__all__ = ["Membrane", "bending_energy", "bending_force"]


def bending_energy(
    V: Any,
    F: Any = None,
    *,
    kappa: Any = 1.0,
    H0: Any = 0.0,
    method: Optional[str] = None,
    areas: Optional[str] = None,
    bandwidth: Any = None,
    threads: Optional[int] = None,
) -> float:
    """The bending energy E = 2 ∫ κ (H − H0)² dS, 8πκ for a sphere with H0 = 0.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`. Energies are computed in double precision.
    kappa, H0 : float or (n,)
        Bending modulus, an energy, and spontaneous curvature, 1/length.
    method : str, optional
        A method with forces, see `helfrich.METHODS`: its own energy, or a quadrature of
        2 ∫ κ (H − H0)² dS for methods in strong form. By default "gompper-kroll", as in `bending_force`,
        whose forces are then the exact gradient of this energy, and as in `helfrich.effects.Bending`. "auto"
        is "jet".

        "kantor-nelson" has the modulus k̃ = 2κ/√3 of an edge, with which forces are those of κ. Its energy
        includes a Gaussian modulus: 2 ∫ κ (H² − ⅔ K) dS, which is 8πκ/3 for a sphere.

    On an open mesh, "j4", "j6", "j8" and "jet" measure up to the border. The energies of other methods leave out
    about half a row of triangles there, because theirs are the natural boundary conditions at a border that is
    free: a `helfrich.MeshWarning` says which share of the area is missing.

    Raises
    ------
    MeshError
        If V and F are no mesh, or kappa or H0 do not fit it.
    ValueError
        If there is no such method, or a parameter is out of range.

    Examples
    --------
    >>> import helfrich
    >>> from math import pi
    >>> V, F, _ = helfrich.shape("sphere:3", 2562)
    >>> round(helfrich.bending_energy(V, F, method="j6") / (8 * pi), 2)
    1.0
    """
    V, F = both(V, F)
    V = positions(V)
    return _membrane(V, F, (method, kappa, H0, areas, bandwidth), threads).energy(V)


def bending_force(
    V: Any,
    F: Any = None,
    *,
    kappa: Any = 1.0,
    H0: Any = 0.0,
    method: Optional[str] = None,
    density: bool = False,
    areas: Optional[str] = None,
    bandwidth: Any = None,
    out: Optional[np.ndarray] = None,
    threads: Optional[int] = None,
) -> np.ndarray:
    """The bending force (n, 3): nodal forces, or the force density.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`.
    kappa, H0 : float or (n,)
        Bending modulus, an energy, and spontaneous curvature, 1/length. "kantor-nelson" takes k̃ = 2κ/√3 for
        the modulus of an edge: its forces are those of κ.
    method : str, optional
        A method with forces. By default nodal forces are those of "gompper-kroll", as the energies of
        `bending_energy` are: exact gradients. Divided by areas they do not converge, so the default for
        densities is "auto": osculating jets of the degree that suits the mesh, which average noise of the
        positions, as in `curvature`.
    density : bool
        Whether to return f = 2 κ [Δ_S H + 2 H (H² − K)] n, force per area, instead of forces. Where it
        is not defined, as at a boundary, it is 0.
    out : (n, 3), optional
        Array for the nodal forces, with the number type of V.

    Returns
    -------
    (n, 3), with the number type of V
        Nodal forces −∂E/∂x, computed in double precision; those of methods in strong form are f times
        areas, freed of their net force and torque. Methods with an energy have exact gradients.

    Raises
    ------
    MeshError
        If V and F are no mesh, or kappa or H0 do not fit it.
    ValueError
        If there is no such method, a parameter is out of range, or out cannot be written to.

    Examples
    --------
    >>> import helfrich
    >>> V, F, exact = helfrich.shape("discocyte", 2562)
    >>> f = helfrich.bending_force(V, F, density=True)
    >>> error = abs((f * exact.normal).sum(axis=1) - exact.f).max() / abs(exact.f).max()
    >>> bool(error < 0.05)
    True
    """
    V, F = both(V, F)
    if not _checks.flag(density, "density"):
        V = positions(V)
        return _membrane(V, F, (method, kappa, H0, areas, bandwidth), threads).force(V, out=out)
    if out is not None:
        raise ValueError("out is for nodal forces: leave it out with density=True")
    method = "auto" if method is None else method
    found = _answer(
        V, F, method=method, kappa=kappa, H0=H0, areas=areas, bandwidth=bandwidth, force=True, threads=threads
    )  # fmt: skip
    if not _has_force(method):
        raise ValueError(f"{method} measures curvatures only and has no force: choose a bending method")
    return found["f"]


def _membrane(V: np.ndarray, F: Any, bending: tuple, threads: Optional[int]) -> Membrane:
    method, kappa, H0, areas, bandwidth = bending
    effect = Bending(Bending.method if method is None else method, kappa, H0, areas, bandwidth)
    return Membrane(F, effect, vertices=len(V), threads=threads)


def _described(name: str) -> Dict[str, Any]:
    """The entry of a method in `METHODS`, by its name or letter; empty if there is none."""
    known = (m for m in _helfrich.METHODS if name.lower() in (m["name"], (m["letter"] or "").lower()))
    return next(known, {})


def _has_force(name: str) -> bool:
    return _described(name).get("has_force", True)


def differentiable(membrane: Any) -> Membrane:
    """The membrane, if its forces are the exact negative gradients of its energy."""
    if not isinstance(membrane, Membrane):
        raise TypeError(f"membrane is {_checks.shown(membrane)}: a helfrich.Membrane is needed")
    (_, *effects), _ = membrane.__getnewargs_ex__()
    for effect in effects:
        if isinstance(effect, Bending) and not _described(effect.method).get("is_conservative"):
            exact = ", ".join(m["name"] for m in _helfrich.METHODS if m["is_conservative"])
            raise ValueError(
                f"the method {effect.method} has forces that are no gradient of an energy: choose one of {exact}"
            )
        if getattr(effect, "exact", False):
            raise ValueError(
                f"{type(effect).__name__} with exact=True is no energy, and removes a part of the forces: give it a "
                "modulus instead"
            )
    return membrane
