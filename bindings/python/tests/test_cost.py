"""What calls cost beside the evaluation, and what they do not copy."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

import helfrich
from helfrich import _helfrich, effects


def overhead(membrane, V, out, calls=2000):
    """Time of calls beside that of the evaluations in them, over the latter, in one run."""
    before = sum(seconds for _, _, seconds in membrane.costs)
    start = time.perf_counter()
    for _ in range(calls):
        membrane.force(V, out=out)
    elapsed = time.perf_counter() - start
    evaluating = sum(seconds for _, _, seconds in membrane.costs) - before
    return elapsed / evaluating - 1


@pytest.mark.skipif(
    "HELFRICH_UNOPTIMISED" in os.environ, reason="the module is not optimised: .ci/bindings --wheel"
)
def test_a_call_costs_little_beside_the_evaluation():
    V, F, _ = helfrich.shape("discocyte", 642)
    membrane = helfrich.Membrane(F, effects.Bending("gompper-kroll"))
    out = np.empty_like(V)
    # Other work on the machine only adds to it: the least counts.
    found = min(overhead(membrane, V, out) for _ in range(10))
    print(f"overhead of a call: {100 * found:.1f} %")
    assert found < 0.10


def address(array):
    return array.__array_interface__["data"][0]


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_positions_are_read_in_place(kind):
    V = np.zeros((1000, 3), kind)
    assert _helfrich.address(V) == address(V)
    assert _helfrich.address(V[10:]) == address(V) + 10 * V.strides[0]
    frozen = V.view()
    frozen.flags.writeable = False
    assert _helfrich.address(frozen) == address(V)
    fortran = np.asfortranarray(V)
    assert _helfrich.address(fortran) != address(fortran)


MEMORY = """
import resource, sys
import numpy as np
import helfrich
from helfrich import _helfrich, effects

peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1024 if sys.platform != "darwin" else 1)
V, F, _ = helfrich.shape("torus", 1_000_000)
faces = F.astype(np.int64)
membrane = helfrich.Membrane(faces, effects.Bending("gompper-kroll"))
assert _helfrich.address(V) == V.__array_interface__["data"][0]
out = np.empty_like(V)
membrane.force(V, out=out)
moved = 1.1 * V
before = peak()
for positions in (V, moved):
    membrane.energy_and_force(positions, out=out)
    membrane.energy(positions)
grown = peak() - before
print(len(V), "vertices,", V.nbytes >> 20, "MB of positions, the peak grew by", grown >> 10, "kB")
assert grown < V.nbytes / 50
faces[12345, 1] = len(V)
try:
    helfrich.Membrane(faces, vertices=len(V))
except helfrich.MeshError as error:
    assert (error.face, error.vertex) == (12345, len(V))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="peak memory: Windows does not tell it")
def test_a_million_vertices():
    """After the first evaluation, which sets up memory, others of other positions take none."""
    ended = subprocess.run([sys.executable, "-c", MEMORY], capture_output=True, text=True)
    print(ended.stdout)
    assert ended.returncode == 0, ended.stderr
