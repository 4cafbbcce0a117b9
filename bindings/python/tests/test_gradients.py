"""Energies that PyTorch and JAX differentiate."""

import functools

import numpy as np
import pytest

import helfrich
from conftest import rough
from helfrich import effects as e

V, F = rough(42)
# A modulus for each vertex, and a reference away from the positions: every effect has a gradient.
KAPPA = 1 + 0.5 * (V[:, 0] > 0)
PARTS = [e.Bending(kappa=KAPPA, H0=0.2), e.Skalak(1.3, 5.0, reference=1.1 * V), e.Volume(3.0, 2.0), e.Tension(0.3)]
STRONG = [m["name"] for m in helfrich.METHODS if m["has_force"] and not m["is_conservative"]]


def refuses_what_has_no_gradient(library):
    for method in [*STRONG, "J", "auto"]:
        with pytest.raises(ValueError, match=f"{method} has forces that are no gradient.* gompper-kroll"):
            library.energy(helfrich.Membrane(F, e.Tension(1.0), e.Bending(method)))
    with pytest.raises(ValueError, match="Volume with exact=True.* modulus"):
        library.energy(helfrich.Membrane(F, e.Bending(), e.Volume(target=2.0, exact=True)))
    with pytest.raises(TypeError, match="membrane is 3: a helfrich.Membrane"):
        library.energy(3)


def test_torch():
    torch = pytest.importorskip("torch")
    import helfrich.torch as library

    x = torch.tensor(V, requires_grad=True)
    membrane = helfrich.Membrane(F, *PARTS)
    energy = library.energy(membrane)
    assert torch.autograd.gradcheck(energy, x)
    assert torch.autograd.gradcheck(lambda x: energy(2 * x) ** 2, x)
    assert torch.autograd.gradcheck(lambda x: library.bending_energy(x, F, kappa=KAPPA, method="juelicher"), x)
    assert library.bending_energy(x, F, kappa=2.0).item() == helfrich.bending_energy(V, F, kappa=2.0)
    assert energy(x.detach()).item() == membrane.energy(V) and not energy(x.detach()).requires_grad
    single = torch.tensor(V, dtype=torch.float32, requires_grad=True)
    found = energy(single)
    found.backward()
    assert found.dtype == single.grad.dtype == torch.float32
    np.testing.assert_array_equal(-single.grad.numpy(), membrane.force(V.astype(np.float32)))
    (first,) = torch.autograd.grad(energy(x) ** 2, x, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        first.sum().backward()


def test_torch_refuses():
    torch = pytest.importorskip("torch")
    import helfrich.torch as library

    refuses_what_has_no_gradient(library)
    x = torch.tensor(V, requires_grad=True)
    with pytest.raises(ValueError, match="j6 has forces that are no gradient"):
        library.bending_energy(x, F, method="j6")
    with pytest.raises(ValueError, match="kappa requires a gradient.*detach"):
        library.bending_energy(x, F, kappa=torch.tensor(1.0, requires_grad=True))
    for wrong in (V, x[0], torch.tensor([[1, 2, 3]])):
        with pytest.raises(TypeError, match=r"(?s)V is .*: a tensor \(n, 3\)"):
            library.bending_energy(wrong, F)
    for wrong in (x[:-1], x * float("nan")):
        with pytest.raises(helfrich.MeshError):
            library.energy(helfrich.Membrane(F, e.Bending()))(wrong)


@pytest.fixture
def jax():
    jax = pytest.importorskip("jax")
    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    yield jax
    jax.config.update("jax_enable_x64", before)


def test_jax(jax):
    from jax import test_util

    import helfrich.jax as library

    membrane = helfrich.Membrane(F, *PARTS)
    energy = library.energy(membrane)
    # Forward and backward, with central differences whose error, third derivatives times the square of the step,
    # is below the tolerances of 1e-5: at the default step of 1e-4 it is 5e-5 on this mesh.
    check_grads = functools.partial(test_util.check_grads, order=1, eps=1e-5)
    check_grads(energy, (V,))
    check_grads(jax.jit(lambda V: energy(2 * V) ** 2), (V,))
    check_grads(lambda V: library.bending_energy(V, F, kappa=KAPPA, method="juelicher"), (V,))
    assert library.bending_energy(V, F, kappa=2.0) == helfrich.bending_energy(V, F, kappa=2.0)
    assert jax.jit(energy)(V) == membrane.energy(V)
    both = np.stack([V, 1.1 * V])
    np.testing.assert_array_equal(jax.vmap(energy)(both), [membrane.energy(V) for V in both])
    np.testing.assert_array_equal(-jax.vmap(jax.grad(energy))(both), [membrane.force(V) for V in both])
    single = V.astype(np.float32)
    found, gradient = jax.value_and_grad(energy)(single)
    assert found.dtype == gradient.dtype == np.float32
    np.testing.assert_array_equal(-gradient, membrane.force(single))
    with pytest.raises(NotImplementedError, match="first derivatives only"):
        jax.hessian(energy)(V)


def test_jax_refuses(jax):
    import helfrich.jax as library

    refuses_what_has_no_gradient(library)
    with pytest.raises(ValueError, match="j6 has forces that are no gradient"):
        library.bending_energy(V, F, method="j6")
    energy = library.energy(helfrich.Membrane(F, e.Bending()))
    for wrong, text in ((V[:-1], "41|vertices"), (V * np.nan, "finite|nan")):
        with pytest.raises(Exception, match=text):
            jax.jit(energy)(wrong).block_until_ready()
