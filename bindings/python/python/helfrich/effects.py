"""Effects that act on a membrane: small values with the words of scenes, for `helfrich.Membrane`.

Each has an energy E and the force −∂E/∂x. Numbers are in any one system of units. A number "at the
vertices" is one for all, or an array (n,); a number "of the components" is one for all, or an array with
one for each connected component.

All have exact gradients, except `Bending` by the methods in strong form: meyer, belkin, farutin, j4, j6,
j8 and jet, whose forces converge where gradients do not.

Examples
--------
>>> import helfrich
>>> from helfrich.effects import Bending, Volume
>>> V, F, exact = helfrich.shape("ellipsoid", 642)
>>> cell = helfrich.Membrane(F, Bending("gompper-kroll", kappa=2.0), Volume(modulus=10, target=2.0))
>>> energy, force = cell.energy_and_force(V)
>>> force.shape
(642, 3)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional, Sequence

__all__ = [
    "Adhesion",
    "Area",
    "AreaDifference",
    "Bending",
    "BorderTension",
    "GaussianBending",
    "Gravity",
    "LineTension",
    "Loads",
    "LocalArea",
    "NeoHookean",
    "Pressure",
    "Skalak",
    "Tension",
    "Volume",
]


@dataclass(frozen=True, eq=False)
class Bending:
    """Bending: E = 2 ∫ κ (H − H0)² dS.

    `kappa` (energy) and `H0` (1/length) are numbers at the vertices. Methods are listed in
    `helfrich.METHODS`; `areas` and `bandwidth` are options of those that have them. "kantor-nelson" has
    the modulus k̃ = 2κ/√3 of an edge: its forces are those of κ, and its energy is 2 ∫ κ (H² − ⅔ K) dS.

    On an open mesh, energies of methods other than j4, j6, j8 and jet leave out about half a row of triangles at
    the border, with a `helfrich.MeshWarning`.
    """

    method: str = "gompper-kroll"
    kappa: Any = 1.0
    H0: Any = 0.0
    areas: Optional[str] = None
    bandwidth: Any = None


@dataclass(frozen=True, eq=False)
class GaussianBending:
    """Bending by the Gaussian modulus: E = ∫ κ_G K dS, with `modulus` κ_G (energy) at the vertices.

    It has forces at boundaries, and where κ_G varies.
    """

    modulus: Any


@dataclass(frozen=True, eq=False)
class NeoHookean:
    """In-plane elasticity of a neo-Hookean membrane with the stress-free positions `reference` (n, 3).

    `shear_modulus` is G, force per length: a third of the E_s that some articles give.
    """

    shear_modulus: float
    reference: Any


@dataclass(frozen=True, eq=False)
class Skalak:
    """In-plane elasticity by Skalak's law with the stress-free positions `reference` (n, 3).

    `shear_modulus` is G, force per length, and `area_ratio` is C: the area modulus is (1 + 2 C) G.
    """

    shear_modulus: float
    area_ratio: float
    reference: Any


@dataclass(frozen=True, eq=False)
class LocalArea:
    """Resistance of each triangle to changes of its area in the positions `reference` (n, 3).

    `modulus` is k_a, force per length.
    """

    modulus: float
    reference: Any


@dataclass(frozen=True, eq=False)
class Area:
    """Penalty on the total area: E = k/2 (A − A0)²/A0 of each component.

    `modulus` is k, energy per area, and `target` A0 of the components. With `exact`, there is no modulus:
    forces do not change the area, and `Membrane.restore` sets it to the target. Beside `Bending("galerkin")` it is
    the area of the patches of that method, otherwise that of the triangles.
    """

    modulus: Optional[float] = None
    target: Any = None
    exact: bool = False


@dataclass(frozen=True, eq=False)
class Volume:
    """Penalty on the enclosed volume: E = k/2 (V − V0)²/|V0| of each component without boundary.

    `modulus` is k, a pressure, and `target` V0 of the components. With `exact`, there is no modulus:
    forces do not change the volume, and `Membrane.restore` sets it to the target. Beside `Bending("galerkin")`
    it is the volume of the patches of that method, otherwise that of the triangles.
    """

    modulus: Optional[float] = None
    target: Any = None
    exact: bool = False


@dataclass(frozen=True, eq=False)
class AreaDifference:
    """Area difference of the leaflets of a bilayer: E = 2π κ̄ (M − M0)²/A, with M = ∫ H dS.

    `modulus` is κ̄, an energy, and `target` M0 = ΔA0/(2 D) of the components, a length. With `exact`,
    there is no modulus: forces do not change M, and `Membrane.restore` sets it to the target.
    """

    modulus: Optional[float] = None
    target: Any = None
    exact: bool = False


@dataclass(frozen=True, eq=False)
class Tension:
    """Surface tension: E = σ A, with `value` σ, energy per area, positive if it contracts."""

    value: float


@dataclass(frozen=True, eq=False)
class Pressure:
    """Pressure inside minus outside: E = −Δp V, with `value` Δp, energy per volume, positive if it
    inflates."""

    value: float


@dataclass(frozen=True, eq=False)
class LineTension:
    """Line tension of the boundary: E = Λ L, with `value` Λ, energy per length, positive if it
    contracts."""

    value: float


@dataclass(frozen=True, eq=False)
class BorderTension:
    """Line tension of the borders between domains: E = Λ L, with `value` Λ, energy per length.

    `domains` are whole numbers, one for each vertex (n,) or for each face (m,).
    """

    value: float
    domains: Any


@dataclass(frozen=True, eq=False)
class Gravity:
    """Weight of the enclosed fluid minus that of the fluid that it displaces.

    E = −Δρ g·∫ (x − x_level) dV, with `density_difference` Δρ and `acceleration` g, a vector.
    """

    density_difference: float
    acceleration: Sequence[float]
    level: Sequence[float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Adhesion:
    """Adhesion to a plane wall: E = ∫ W (q² − 2 q) dS, q = exp(−(z − d)/λ) at the height z.

    `strength` is W, energy per area, `distance` d, `range` λ, `wall` a point of the wall, and `normal`
    its direction towards the membrane.
    """

    strength: float
    distance: float
    range: float
    wall: Sequence[float] = (0.0, 0.0, 0.0)
    normal: Sequence[float] = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Loads:
    """Constant forces on some vertices: E = −Σ F·x, with `vertices` (k,) and `forces` (k, 3)."""

    vertices: Any
    forces: Any
