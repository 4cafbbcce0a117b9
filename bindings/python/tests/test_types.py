"""Annotations, by the programs that check them."""

import subprocess
import sys
from pathlib import Path

import pytest

# What users write, and the type of each result; errors are expected in lines that say so.
PROGRAM = """
import pickle
from typing import Optional

import numpy as np

import helfrich
from helfrich.effects import Bending

V, F, exact = helfrich.shape("sphere", 42)
c = helfrich.curvature(V, F)
print(c.error.H.max(), c.K.max(), c.k1.max(), exact.H.max())
d = helfrich.curvature(V, F, directions=True)
print(d.d1.shape, d.error.f)
b = helfrich.curvature(V, F, method="meyer", errors=True)
print(b.error.K)
any_of_them: helfrich.Curvature = helfrich.curvature(V, F, method="meyer")
bars: Optional[helfrich.Errors] = any_of_them.error
membrane: helfrich.Membrane = helfrich.Membrane(F, Bending(), vertices=42)
energy, force = membrane.energy_and_force(V)
print(energy + 1.0, force.shape, pickle.loads(pickle.dumps(membrane)))
print(helfrich.bending_energy(V, F) + 1.0, helfrich.bending_force(V, F).shape)
print(helfrich.curvature(V, F, method="meyer").error.H)  # wrong
"""


@pytest.mark.parametrize("checker", ["mypy", "pyright"])
def test_programs_of_users_pass(checker, tmp_path):
    path = Path(sys.executable).with_name(checker)
    if not path.exists():
        pytest.skip(f"{checker}: it is not installed beside Python")
    program = tmp_path / "program.py"
    program.write_text(PROGRAM, encoding="utf-8")
    options = {
        "mypy": ["--python-executable", sys.executable, "--cache-dir", str(tmp_path)],
        "pyright": ["--pythonpath", sys.executable],
    }
    ended = subprocess.run(
        [path, *options[checker], str(program)], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    line = PROGRAM.splitlines().index('print(helfrich.curvature(V, F, method="meyer").error.H)  # wrong') + 1
    errors = [row for row in ended.stdout.splitlines() if "error" in row and "program.py" in row]
    assert len(errors) == 1 and f":{line}" in errors[0], ended.stdout + ended.stderr
