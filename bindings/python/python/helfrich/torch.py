"""Energies with gradients for PyTorch: `import helfrich.torch`.

Gradients with respect to positions are those of `Membrane.force`: exact, of first order only, and computed on the
processor in double precision, wherever the tensors are. Moduli and reference positions are constants.
"""

from __future__ import annotations

from typing import Any, Callable, Optional

try:
    import torch
except ImportError as error:
    raise ImportError("helfrich.torch needs PyTorch: pip install torch") from error

from . import _checks
from ._membranes import Membrane, _membrane, differentiable

__all__ = ["bending_energy", "energy"]


def _positions(V: Any) -> Any:
    if not isinstance(V, torch.Tensor) or V.ndim != 2 or not V.is_floating_point():
        raise TypeError(f"V is {_checks.shown(V)}: a tensor (n, 3) of floating-point numbers is needed")
    return V


class _Energy(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, V: Any, membrane: Membrane) -> Any:
        positions = V.detach().cpu().numpy()
        if not ctx.needs_input_grad[0]:
            return V.new_tensor(membrane.energy(positions))
        energy, force = membrane.energy_and_force(positions)
        ctx.save_for_backward(torch.from_numpy(force).to(V))
        return V.new_tensor(energy)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, scale: Any) -> Any:
        (force,) = ctx.saved_tensors
        return -scale * force, None


def energy(membrane: Membrane) -> Callable[[Any], Any]:
    """The energy of a membrane as a function of the positions that PyTorch differentiates.

    Parameters
    ----------
    membrane : helfrich.Membrane
        A mesh with effects that all have an energy.

    Returns
    -------
    function
        It takes V (n, 3), a tensor of any device, and returns the energy, a tensor () of the same kind.

    Raises
    ------
    ValueError
        If forces of the membrane are no gradients: of a method in strong form, or with `exact=True`.
    TypeError
        If it is no membrane.

    Examples
    --------
    >>> import helfrich.torch, torch
    >>> from helfrich.effects import Bending, Volume
    >>> V, F, _ = helfrich.shape("ellipsoid", 162)
    >>> E = helfrich.torch.energy(helfrich.Membrane(F, Bending(), Volume(10.0, 2.0)))
    >>> x = torch.tensor(V, requires_grad=True)
    >>> E(x).backward()
    >>> x.grad.shape
    torch.Size([162, 3])
    """
    membrane = differentiable(membrane)
    return lambda V: _Energy.apply(_positions(V), membrane)


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
    """The bending energy of `helfrich.bending_energy` as a tensor () with a gradient.

    Arguments are those of `helfrich.bending_energy`, with a tensor V (n, 3). Each call checks the mesh: in a loop,
    `energy` is faster.

    Raises
    ------
    MeshError
        If V and F are no mesh, or kappa or H0 do not fit it.
    ValueError
        If the method has no exact gradient, or a parameter is out of range or requires a gradient.

    Examples
    --------
    >>> import helfrich.torch, torch
    >>> V, F, _ = helfrich.shape("sphere", 162)
    >>> x = torch.tensor(V, requires_grad=True)
    >>> helfrich.torch.bending_energy(x, F).backward()
    >>> bool(torch.allclose(-x.grad, torch.from_numpy(helfrich.bending_force(V, F))))
    True
    """
    for name, value in {"kappa": kappa, "H0": H0}.items():
        if getattr(value, "requires_grad", False):
            raise ValueError(f"{name} requires a gradient, but only V has one: take {name}.detach()")
    return energy(_membrane(_positions(V), F, (method, kappa, H0, areas, bandwidth), threads))(V)
