"""Meshes and the program, for all tests."""

import os
import shutil
import subprocess

import numpy as np
import pytest

import helfrich


def rough(n=162, spec="ellipsoid:1,0.8,0.7", noise=0.02, seed=1):
    """A closed mesh in no special position: vertices displaced by a share of the size."""
    V, F, _ = helfrich.shape(spec, n, family="irregular", seed=seed)
    rng = np.random.default_rng(seed)
    return V + noise * rng.standard_normal(V.shape), F


def part(V, F, kept):
    """The faces all of whose vertices are kept, and their vertices."""
    F = F[kept[F].all(axis=1)]
    used, F = np.unique(F, return_inverse=True)
    return np.ascontiguousarray(V[used]), F.reshape(-1, 3)


def cap(n=162):
    """An open mesh: the upper part of a rough one."""
    V, F = rough(n)
    return part(V, F, V[:, 2] > -0.1)


@pytest.fixture(scope="session")
def program():
    """Calls the program `helfrich`, which HELFRICH names."""
    path = os.environ.get("HELFRICH") or shutil.which("helfrich")
    if path is None:
        pytest.skip("the program helfrich: HELFRICH does not name it")

    def call(*arguments):
        ended = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True)
        assert ended.returncode == 0, ended.stderr
        return ended.stdout

    return call
