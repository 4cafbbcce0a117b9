"""Which method."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence

from . import _checks, _helfrich
from ._arrays import both


@dataclass(frozen=True)
class Recommendation:
    """The result of `recommend`."""

    method: Optional[str]
    """The fastest method that reaches the target, or the nearest to it; None if nothing is known."""
    scalar: Optional[str]
    """Its number type, "f32" or "f64"."""
    expected: Optional[float]
    """Its expected error, relative to the largest value on the surface."""
    seconds: Optional[float]
    """The time of one evaluation on one thread."""
    reaches: bool
    """Whether it reaches the target."""
    is_resolved: bool
    """Whether the mesh resolves the shape; if not, no estimate is reliable."""
    noise: float
    """Noise of the positions, a length; 0 if none was found."""
    vertices_needed: Optional[float]
    """If no method reaches the target: the number of vertices that would do."""
    candidates: List[Dict[str, Any]]
    """Everything that was measured, fastest first, as `helfrich recommend --json` writes it."""


def recommend(
    V: Any,
    F: Any = None,
    *,
    error: float = 0.01,
    quantity: str = "f",
    norm: str = "max",
    methods: Optional[Sequence[str]] = None,
    scalars: Sequence[str] = ("f32", "f64"),
    threads: Optional[int] = None,
) -> Recommendation:
    """The cheapest method for an accuracy on a mesh of yours, by measurements on that mesh.

    Parameters
    ----------
    V, F
        The mesh, as in `curvature`.
    error : float
        Largest allowed error, relative to the largest value on the surface.
    quantity : str
        "H", "K", "LapH" or "f".
    norm : str
        "max", at every vertex, or "mean".
    methods : sequence of str, optional
        Methods to choose from, all by default.
    scalars : sequence of str
        Number types to choose from: "f32", "f32-pair", "f64".

    Returns
    -------
    Recommendation
        `method scalar expected seconds reaches is_resolved noise vertices_needed candidates`.

    Raises
    ------
    MeshError
        If V and F are no mesh, or no vertex can be compared.
    ValueError
        If a name is unknown.

    Examples
    --------
    >>> import helfrich
    >>> V, F, _ = helfrich.shape("sphere", 642)
    >>> best = helfrich.recommend(V, F, error=0.05, quantity="H", methods=["B", "j4", "j6"])
    >>> best.reaches
    True
    """
    V, F = both(V, F)
    text = _helfrich.recommend(
        V,
        F,
        error=_checks.number(error, "error"),
        quantity=_checks.text(quantity, "quantity"),
        norm=_checks.text(norm, "norm"),
        methods=None if methods is None else _checks.texts(methods, "methods"),
        scalars=_checks.texts(scalars, "scalars"),
        threads=_checks.threads(threads),
    )
    found = json.loads(text)
    best = found["choice"] or found["nearest"] or {}
    return Recommendation(
        method=best.get("method"),
        scalar=best.get("scalar"),
        expected=best.get("expected"),
        seconds=best.get("seconds"),
        reaches=found["choice"] is not None,
        is_resolved=found["is_resolved"],
        noise=found["noise"]["length"],
        vertices_needed=found["vertices_needed"],
        candidates=found["candidates"],
    )
