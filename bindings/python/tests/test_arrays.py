"""Arrays of every kind: in place where possible, copied where necessary, refused with their reason."""

import copy
import pickle
import re
import threading
import time

import numpy as np
import pytest

import helfrich
from conftest import rough
from helfrich import effects

INTEGERS = ["int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "longlong"]


def curvature(V, F):
    return helfrich.curvature(V, F, method="meyer").H


@pytest.mark.parametrize("name", INTEGERS)
def test_faces_of_any_integer_type(name):
    V, F = rough(42)
    expected = curvature(V, F)
    kind = np.dtype(name)
    for faces in (F.astype(kind), F.astype(kind.newbyteorder()), np.asfortranarray(F.astype(kind))):
        np.testing.assert_array_equal(curvature(V, faces), expected)


def layouts(V):
    wide = np.zeros((len(V), 6), V.dtype)
    wide[:, ::2] = V
    unaligned = np.frombuffer(b"x" + V.tobytes(), V.dtype, offset=1).reshape(V.shape)
    frozen = V.copy()
    frozen.flags.writeable = False

    class Tracked(np.ndarray):
        """A subclass, as trimesh's."""

    return {
        "Fortran": np.asfortranarray(V),
        "strided": wide[:, ::2],
        "backward": V[::-1].copy()[::-1],
        "mirrored": V[:, ::-1].copy()[:, ::-1],
        "unaligned": unaligned,
        "other bytes": V.astype(V.dtype.newbyteorder()),
        "read-only": frozen,
        "subclass": V.view(Tracked),
        "list": V.tolist() if V.dtype == np.float64 else V,
    }


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_positions_of_any_layout(kind):
    V, F = rough(42)
    V = V.astype(kind)
    expected = curvature(V, F)
    assert expected.dtype == kind
    force = helfrich.Membrane(F, effects.Bending()).force(V)
    assert force.dtype == kind
    for name, same in layouts(V).items():
        np.testing.assert_array_equal(curvature(same, F), expected, name)
        np.testing.assert_array_equal(helfrich.Membrane(F, effects.Bending()).force(same), force, name)


def test_whole_numbers_are_positions():
    V = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    F = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    assert helfrich.check(V, F).volume == pytest.approx(1 / 6)


def refused(call, **places):
    with pytest.raises(helfrich.MeshError) as caught:
        call()
    for name, place in places.items():
        assert getattr(caught.value, name) == place, name
    return str(caught.value)


def test_errors_name_the_place():
    V, F = rough(42)
    bad = V.copy()
    bad[7, 1] = np.nan
    assert "vertex 7" in refused(lambda: curvature(bad, F), vertex=7, face=None)
    faces = F.astype(np.int64)
    faces[5, 2] = -1
    assert "-1" in refused(lambda: curvature(V, faces), face=5)
    faces[5, 2] = 2**40
    refused(lambda: curvature(V, faces), face=5)
    faces[5, 2] = 42
    refused(lambda: curvature(V, faces), face=5, vertex=42)
    faces = F.copy()
    faces[3] = faces[3, ::-1]
    assert refused(lambda: curvature(V, faces), vertex=None)
    with pytest.raises(helfrich.MeshError) as caught:
        curvature(V, faces)
    assert set(caught.value.edge) <= set(faces[3])
    assert "(n, 3)" in refused(lambda: curvature(V[:, :2], F))
    assert "(m, 3)" in refused(lambda: curvature(V, F.ravel()))
    assert "float64" in refused(lambda: curvature(V, F.astype(float)))
    assert "complex" in refused(lambda: curvature(V.astype(complex), F))
    refused(lambda: curvature([[1, 2, 3], [4, 5]], F))
    refused(lambda: curvature(V[:-1], F), vertex=41)
    refused(lambda: curvature(np.empty((0, 3)), np.empty((0, 3), int)))
    refused(lambda: helfrich.Membrane(F, effects.Bending()).force(V[:-1]))


def test_parameters_are_checked():
    V, F = rough(42)
    for method in ["nonsense", "", "é"]:
        with pytest.raises(ValueError, match="there is no bending method"):
            helfrich.curvature(V, F, method=method)
    with pytest.raises(ValueError, match="defines no curvatures"):
        helfrich.curvature(V, F, method="kantor-nelson")
    with pytest.raises(ValueError, match="does not define K"):
        helfrich.gaussian_curvature(V, F, method="gompper-kroll")
    with pytest.raises(ValueError, match="no spontaneous curvature"):
        helfrich.bending_energy(V, F, method="A", H0=1.0)
    with pytest.raises(ValueError, match="choose another method"):
        helfrich.bending_energy(V, F, method="A", kappa=np.arange(42.0))
    with pytest.raises(ValueError, match="has no force"):
        helfrich.bending_force(V, F, method="corrected")
    with pytest.raises(ValueError, match="has no force"):
        helfrich.bending_force(V, F, method="corrected", density=True)
    with pytest.raises(ValueError, match="not a finite number"):
        helfrich.bending_energy(V, F, kappa=np.nan)
    with pytest.raises(ValueError, match="1e300|overflow"):
        helfrich.bending_energy(V, F, kappa=1e300)
    with pytest.raises(ValueError, match="41"):
        helfrich.bending_energy(V, F, kappa=np.ones(41))
    with pytest.raises(ValueError, match="threads"):
        helfrich.curvature(V, F, threads=0)
    with pytest.raises(TypeError, match="no effect"):
        helfrich.Membrane(F, "bending")
    with pytest.raises(ValueError, match="28 to 4096"):
        helfrich.curvature(V, F, scale=5)
    with pytest.raises(ValueError, match="leave one of them out"):
        helfrich.curvature(V, F, scale=50, radius=0.5)


def test_out():
    V, F = rough(42)
    membrane = helfrich.Membrane(F, effects.Bending())
    expected = membrane.force(V)
    out = np.full_like(V, np.nan)
    assert membrane.force(V, out=out) is out
    np.testing.assert_array_equal(out, expected)
    assert membrane.energy_and_force(V, out)[0] == membrane.energy(V)
    frozen = out.copy()
    frozen.flags.writeable = False
    shared = np.zeros(2 * V.size)
    first, second = shared[: V.size].reshape(-1, 3), shared[3 : V.size + 3].reshape(-1, 3)
    first[:] = V
    buffer = bytearray(V.tobytes())
    twins = [np.frombuffer(buffer).reshape(-1, 3) for _ in range(2)]
    for positions, array in [(V, frozen), (V, V), (first, second), tuple(twins), (V, out[::-1]), (V, out.T)]:
        with pytest.raises(ValueError):
            membrane.force(positions, out=array)
    for array in [out.astype(np.float32), [1.0], "out", np.zeros(3)]:
        with pytest.raises((TypeError, ValueError)):
            membrane.force(V, out=array)
    np.testing.assert_array_equal(membrane.force(V, out=None), expected)


def test_results_do_not_depend_on_threads():
    V, F = rough(20000, "discocyte", 1e-4)
    for method in ["gompper-kroll", "j4"]:
        forces = [helfrich.bending_force(V, F, method=method, threads=n) for n in (1, 2, 3)]
        np.testing.assert_array_equal(forces[0], forces[1])
        np.testing.assert_array_equal(forces[0], forces[2])


def test_the_lock_of_the_interpreter_is_released():
    """While one thread evaluates, another one counts."""
    V, F, _ = helfrich.shape("discocyte", 10242)
    membrane = helfrich.Membrane(F, effects.Bending("j6"), threads=1)
    membrane.force(V)
    worker = threading.Thread(target=lambda: [membrane.force(V) for _ in range(5)])
    worker.start()
    ticks = []
    while worker.is_alive():
        ticks.append(time.perf_counter())
        time.sleep(0.001)
    worker.join()
    # One evaluation takes tens of milliseconds; held, the lock would leave one tick for each.
    assert len(ticks) > 20


def test_threads_may_share_a_membrane():
    V, F = rough(162)
    membrane = helfrich.Membrane(F, effects.Bending())
    inputs = [V * scale for scale in np.linspace(0.5, 2, 8)]
    expected = [membrane.force(x) for x in inputs]
    wrong = []

    def work(x, force):
        for _ in range(200):
            if not np.array_equal(membrane.force(x), force):
                wrong.append(1)

    threads = [threading.Thread(target=work, args=pair) for pair in zip(inputs, expected)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert not wrong


def test_values_are_never_nan():
    V, F = rough(42)
    F = F[:-6]
    V = V.copy()
    V[F[0, 0]] = V[F[0, 1]]
    for method in helfrich.METHODS:
        if not method["defines"][0]:
            continue
        found = helfrich.curvature(V, F, method=method["name"], errors=True)
        arrays = [a for a in found[:5] if a is not None] + [found.normal, found.area]
        assert all(np.isfinite(array).all() for array in arrays), method
        assert not any(np.isnan(array).any() for array in found.error)
        assert (found.flags & helfrich.Flag.UNKNOWN).any()
        assert (found.H[found.flags & helfrich.Flag.UNKNOWN != 0] == 0).any()


def test_masked_entries_are_refused():
    V, F = rough(42)
    for place, mask in [("V", V == V[9, 2]), ("F", F == F[4, 1])]:
        arrays = {"V": V, "F": F.astype(np.int64)}
        arrays[place] = np.ma.array(arrays[place], mask=mask)
        for call in (curvature, helfrich.bending_energy, helfrich.weld, helfrich.subdivide):
            message = refused(lambda call=call: call(arrays["V"], arrays["F"]))
            assert re.search(rf"entries of {place} are masked, the first at \[\d+, \d\]: leave", message)
        assert "masked" in str(helfrich.check(arrays["V"], arrays["F"]).problems[0])
    # A mask that hides nothing is none.
    open_mask = np.ma.array(V, mask=np.zeros(V.shape, bool))
    np.testing.assert_array_equal(curvature(open_mask, F), curvature(V, F))
    kappa = np.ma.array(np.ones(42), mask=np.arange(42) == 3)
    assert "kappa are masked" in refused(lambda: helfrich.bending_energy(V, F, kappa=kappa))


@pytest.mark.parametrize("copied", [lambda m: pickle.loads(pickle.dumps(m)), copy.copy, copy.deepcopy])
def test_membranes_are_copied(copied):
    V, F = rough(642)
    reference, kappa = V.copy(), np.linspace(1, 2, len(V))
    parts = [
        effects.Bending("galerkin", kappa=kappa), effects.Skalak(1.0, 2.0, reference), effects.Area(target=3.0, exact=True)
    ]  # fmt: skip
    membrane = helfrich.Membrane(F, *parts, vertices=len(V), threads=1)
    expected = membrane.energy_and_force(V)
    # Of the membrane, and not of arrays that have changed since.
    reference *= 2
    kappa *= 2
    other = copied(membrane)
    assert type(other) is helfrich.Membrane and other is not membrane
    energy, force = other.energy_and_force(V)
    assert energy == expected[0]
    np.testing.assert_array_equal(force, expected[1])
    np.testing.assert_array_equal(copied(other).force(V), expected[1])


class Cell(helfrich.Membrane):
    """A membrane with an attribute."""


def test_membranes_of_other_classes_are_copied():
    V, F = rough(42)
    cell = Cell(F, effects.Bending())
    cell.name = "red"
    other = pickle.loads(pickle.dumps(cell))
    assert type(other) is Cell and other.name == "red" and other.energy(V) == cell.energy(V)


def test_results_are_copied():
    V, F = rough(42)
    for result in (helfrich.curvature(V, F), helfrich.check(V, F), helfrich.MeshError("no mesh", face=3)):
        other = pickle.loads(pickle.dumps(result))
        assert repr(other) == repr(result) and type(other) is type(result)
    assert pickle.loads(pickle.dumps(helfrich.MeshError("no mesh", face=3))).face == 3


def test_components_are_split_and_measured():
    """Interleaved vertices and faces keep their order, and each part has the measures of the mesh alone."""
    ball, torus = helfrich.shape("sphere:2", 162), helfrich.shape("torus:3,1", 200)
    open_ball = ball[0], ball[1][1:]
    meshes = [(mesh[0], mesh[1].astype(int)) for mesh in (torus, ball, open_ball)]
    sizes = [len(V) for V, _ in meshes]
    rng = np.random.default_rng(1)
    # The names of the vertices in the whole, ascending in each mesh; the last vertex is in no face.
    owner = rng.permutation(np.repeat(np.arange(3), sizes))
    names = [np.flatnonzero(owner == k) for k in range(3)]
    whole = np.empty((sum(sizes) + 1, 3))
    whole[-1] = 0
    for (V, _), own in zip(meshes, names):
        whole[own] = V
    faces = rng.permutation(np.concatenate([own[F] for (_, F), own in zip(meshes, names)]))
    order = sorted(range(3), key=lambda k: names[k][0])
    parts, report = helfrich.split(whole, faces), helfrich.check(whole, faces)
    assert len(parts) == len(report.by_component) == report.components == 3
    for k, part, measures in zip(order, parts, report.by_component):
        V, F = part
        np.testing.assert_array_equal(part.vertex_of, names[k])
        np.testing.assert_array_equal(V, meshes[k][0])
        np.testing.assert_array_equal(part.vertex_of[F], faces[part.face_of])
        assert (np.diff(part.face_of) > 0).all() and len(F) == len(meshes[k][1])
        assert helfrich.check(V, F).is_mesh
        alone = helfrich.check(*meshes[k])
        assert measures.first_vertex == names[k][0] and measures.vertices == sizes[k]
        for name in ("faces", "boundary_edges", "euler_characteristic", "genus"):
            assert getattr(measures, name) == getattr(alone, name), name
        assert (measures.volume is None) == (k == 2) == (alone.volume is None)
        for name in ("area", "volume", "total_mean_curvature"):
            assert (getattr(measures, name) or 0) == pytest.approx(getattr(alone, name) or 0, rel=1e-12), name
    assert report.total_mean_curvature == pytest.approx(sum(m.total_mean_curvature for m in report.by_component))
    # ∫ H dS is 4πR on a sphere and 2π²R on a torus, up to squares of the edges, 0.01 and 0.1.
    assert helfrich.check(*meshes[1]).total_mean_curvature == pytest.approx(8 * np.pi, rel=0.03)
    assert helfrich.check(*meshes[0]).total_mean_curvature == pytest.approx(6 * np.pi**2, rel=0.05)
