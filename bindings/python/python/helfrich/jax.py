"""Energies with gradients for JAX: `import helfrich.jax`.

Gradients with respect to positions are those of `Membrane.force`: exact, of first order only, and computed on the
processor in double precision, also within `jax.jit`. Moduli and reference positions are constants.
"""

from __future__ import annotations

from typing import Any, Callable, Optional

try:
    import jax
except ImportError as error:
    raise ImportError("helfrich.jax needs JAX: pip install jax") from error

import jax.numpy as jnp
import numpy as np

from ._membranes import Membrane, _membrane, differentiable

__all__ = ["bending_energy", "energy"]


def _positions(V: Any) -> Any:
    V = jnp.asarray(V)
    return V.astype(jnp.result_type(V.dtype, float))


def energy(membrane: Membrane) -> Callable[[Any], Any]:
    """The energy of a membrane as a function of the positions that JAX differentiates, compiles and maps.

    Both modes of differentiation are possible.

    Parameters
    ----------
    membrane : helfrich.Membrane
        A mesh with effects that all have an energy.

    Returns
    -------
    function
        It takes V (n, 3) and returns the energy, an array () of the same number type. Where V does not fit the mesh
        or is not finite, JAX raises an error of its own with the text of the `helfrich.MeshError`.

    Raises
    ------
    ValueError
        If forces of the membrane are no gradients: of a method in strong form, or with `exact=True`.
    TypeError
        If it is no membrane.

    Examples
    --------
    >>> import helfrich.jax, jax
    >>> from helfrich.effects import Bending, Volume
    >>> V, F, _ = helfrich.shape("ellipsoid", 162)
    >>> E = helfrich.jax.energy(helfrich.Membrane(F, Bending(), Volume(10.0, 2.0)))
    >>> jax.jit(jax.grad(E))(V).shape
    (162, 3)
    """
    membrane = differentiable(membrane)

    def called(function: Callable[[Any], Any], shapes: Any, V: Any) -> Any:
        def call(V: Any) -> Any:
            return jax.tree.map(lambda found: np.asarray(found, V.dtype), function(np.asarray(V)))

        kinds = tuple(jax.ShapeDtypeStruct(shape, V.dtype) for shape in shapes)
        return jax.pure_callback(call, kinds, V, vmap_method="sequential")

    # Rules for tangents, from which JAX has those for cotangents, too.
    @jax.custom_jvp
    def both(V: Any) -> Any:
        return called(membrane.energy_and_force, [(), V.shape], V)

    @both.defjvp
    def second(primals: Any, tangents: Any) -> Any:
        raise NotImplementedError("energies of helfrich have first derivatives only")

    @jax.custom_jvp
    def of(V: Any) -> Any:
        return called(lambda V: (membrane.energy(V),), [()], V)[0]

    @of.defjvp
    def first(primals: Any, tangents: Any) -> Any:
        found, force = both(*primals)
        return found, -jnp.vdot(force, tangents[0])

    return lambda V: of(_positions(V))


def bending_energy(
    V: Any,
    F: Any,
    *,
    kappa: Any = 1.0,
    H0: Any = 0.0,
    method: Optional[str] = None,
    areas: Optional[str] = None,
    bandwidth: Any = None,
    threads: Optional[int] = None,
) -> Any:
    """The bending energy of `helfrich.bending_energy` as an array () with a gradient with respect to V.

    Arguments are those of `helfrich.bending_energy`. Each call checks the mesh: in a loop, `energy` is faster.

    Raises
    ------
    MeshError
        If V and F are no mesh, or kappa or H0 do not fit it.
    ValueError
        If the method has no exact gradient, or a parameter is out of range.

    Examples
    --------
    >>> import helfrich.jax, jax, numpy
    >>> V, F, _ = helfrich.shape("sphere", 162)
    >>> gradient = jax.grad(lambda V: helfrich.jax.bending_energy(V, F))(V)
    >>> bool(numpy.allclose(-gradient, helfrich.bending_force(V, F), atol=1e-5))
    True
    """
    V = _positions(V)
    return energy(_membrane(V, F, (method, kappa, H0, areas, bandwidth), threads))(V)
