"""Arrays from a generator of mischief: every call returns or raises, and the interpreter goes on."""

import os
import warnings

import numpy as np
import pytest

import helfrich
from conftest import rough
from helfrich import effects

CASES = int(os.environ.get("HELFRICH_FUZZ", "1500"))
DTYPES = "f8 f4 f2 g i8 i4 i2 i1 u8 u4 u2 u1 ? c16 S4 U2 O M8[s] >f8 >i4".split()


def mangled(rng, array):
    """The array after some random mischief."""
    for _ in range(rng.integers(1, 4)):
        kind = rng.integers(0, 14)
        if kind == 0:
            array = array[::-1]
        elif kind == 1:
            array = array[..., ::-1]
        elif kind == 2:
            array = np.asfortranarray(array)
        elif kind == 3:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    array = array.astype(rng.choice(DTYPES))
                except (TypeError, ValueError, OverflowError, RuntimeError):
                    pass
        elif kind == 4 and array.size and array.dtype.kind == "f":
            array = array.copy()
            array.flat[rng.integers(array.size)] = rng.choice([np.nan, np.inf, -np.inf, 1e308, 5e-324, 0.0])
        elif kind == 5 and array.size and array.dtype.kind in "iu":
            array = array.copy()
            extreme = np.iinfo(array.dtype)
            array.flat[rng.integers(array.size)] = rng.choice([extreme.min, extreme.max, 0, 41, 42])
        elif kind == 6:
            array = array[: rng.integers(0, len(array) + 1)] if array.ndim else array
        elif kind == 7:
            array = array.copy()
            array.flags.writeable = False
        elif kind == 8:
            array = array.reshape(-1) if rng.integers(2) else array[None]
        elif kind == 9 and array.size:
            array = np.broadcast_to(array.flat[0], array.shape)
        elif kind == 10 and array.dtype.kind in "fiu" and array.size:
            array = np.frombuffer(b"x" + array.tobytes(), array.dtype, offset=1).reshape(array.shape)
        elif kind == 11:
            array = array[..., : rng.integers(0, 4)] if array.ndim else array
        elif kind == 12 and array.ndim == 2:
            array = array.T
        elif kind == 13 and array.ndim == 2 and len(array) > 1:
            array = array[rng.integers(0, len(array), len(array))]
    return array


def calls(rng, V, F):
    method = rng.choice([m["name"] for m in helfrich.METHODS] + ["auto", "none"])
    number = mangled(rng, rng.standard_normal(42)) if rng.integers(2) else float(rng.choice([1, np.nan, 1e200]))
    out = mangled(rng, np.zeros((42, 3))) if rng.integers(2) else (V if isinstance(V, np.ndarray) else None)
    reference = mangled(rng, rough(42)[0])
    chosen = [
        lambda: helfrich.curvature(V, F, method=method, errors=bool(rng.integers(2))),
        lambda: helfrich.bending_energy(V, F, method=method, kappa=number),
        lambda: helfrich.bending_force(V, F, method=method, H0=number, density=bool(rng.integers(2))),
        lambda: helfrich.bending_force(V, F, method="B", out=out),
        lambda: helfrich.Membrane(F, effects.Bending()).force(V, out),
        lambda: helfrich.Membrane(F, effects.Bending()).flags(V),
        lambda: helfrich.Membrane(F, effects.Skalak(1, 1, reference)).energy_and_force(V),
        lambda: helfrich.Membrane(F, effects.BorderTension(1, mangled(rng, np.arange(42)))).force(V),
        lambda: helfrich.Membrane(F, effects.Loads(mangled(rng, np.arange(3)), reference[:3])).energy(V),
        lambda: helfrich.Membrane(F, effects.Area(1, number), effects.GaussianBending(number)).force(V),
        lambda: helfrich.laplacian(V, F, mass=rng.choice(["mixed", "consistent", "voronoi", "x"])),
        lambda: helfrich.laplacian(V, F, method=method),
        lambda: helfrich.gradient(V, F),
        lambda: helfrich.Membrane(
            F, effects.Area(target=number, exact=True), effects.Volume(target=number, exact=True)
        ).restore(V),
        lambda: helfrich.weld(V, F, distance=float(rng.choice([0, 0.1, 1e-300, 1e300]))),
        lambda: helfrich.subdivide(V, F, levels=int(rng.integers(0, 3)), limit=bool(rng.integers(2))),
        lambda: helfrich.write("/nonexistent/x.vtp", V, F, field=number),
    ]
    return chosen[rng.integers(len(chosen))]


def test_mischief():
    pytest.importorskip("scipy")
    good = rough(42)
    returned = 0
    for case in range(CASES):
        rng = np.random.default_rng(case)
        V = mangled(rng, good[0]) if rng.integers(4) else good[0]
        F = mangled(rng, good[1]) if rng.integers(4) else good[1]
        report = helfrich.check(V, F)
        try:
            calls(rng, V, F)()
            returned += 1
        except (ValueError, TypeError, OSError):
            pass
        except BaseException as error:
            raise AssertionError(f"case {case}: {error!r}") from error
        assert isinstance(report, helfrich.Report)
    # Not everything is refused.
    assert returned > CASES / 20


@pytest.mark.parametrize("thing", [None, 3, "mesh", b"", {}, object(), [[]], [None], float("nan"), range(3)])
def test_things_that_are_no_arrays(thing):
    V, F = rough(42)
    for arguments in [(thing, F), (V, thing), (thing, thing)]:
        if thing is None and arguments[0] is V:
            continue
        with pytest.raises((ValueError, TypeError)):
            helfrich.curvature(*arguments)
        assert helfrich.check(*arguments).problems
