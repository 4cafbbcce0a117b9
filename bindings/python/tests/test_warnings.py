"""Surfaces that are inside out, and work that is asked to stop."""

import os
import signal
import subprocess
import sys
import time

import helfrich
import numpy as np
import pytest


def test_inside_out():
    V, F, _ = helfrich.shape("sphere", 162)
    with pytest.warns(helfrich.MeshWarning, match="component 1 of 1 .* is inside out"):
        assert (helfrich.curvature(V, F[:, ::-1]).H < 0).all()
    two = np.concatenate([V, V + 9]), np.concatenate([F, F[:, ::-1] + len(V)])
    for kind in (np.float32, np.float64):
        for method in ("auto", "j6"):
            with pytest.warns(helfrich.MeshWarning, match="component 2 of 2 .* from vertex 162 on") as told:
                helfrich.curvature(two[0].astype(kind), two[1], method=method)
            assert told[0].filename == __file__


ASKED = """
import helfrich, numpy as np
V, F, _ = helfrich.shape("sphere", 40962)
V = V + 1e-4 * np.random.default_rng(1).normal(size=V.shape)
print("ready", flush=True)
try:
    {}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="needs Linux")
@pytest.mark.parametrize(
    "work",
    [
        "helfrich.curvature(V, F)",
        "helfrich.curvature(V, F, method='belkin', errors=True)",
        "helfrich.recommend(V, F)",
        "[helfrich.Membrane(F, helfrich.effects.Bending('belkin')).force(V) for _ in range(9)]",
    ],
)
def test_ctrl_c_ends_within_a_second(work):
    process = subprocess.Popen([sys.executable, "-c", ASKED.format(work)], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"

    def seconds():
        with open(f"/proc/{process.pid}/stat") as entry:
            fields = entry.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    start = seconds()
    while seconds() < start + 0.5:
        time.sleep(0.01)
    before = seconds()
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "interrupted\n"
    assert seconds() - before < 1
    process.wait()
