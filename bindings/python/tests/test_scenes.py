"""Runs of scenes."""

import os
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest

import helfrich

VESICLE = {
    "units": "none",
    "surface": [
        {
            "name": "vesicle",
            "shape": "ellipsoid:0.8,0.8,1.4",
            "vertices": 162,
            "bending": {"method": "gompper-kroll", "modulus": 1},
            "area": {"constraint": "exact"},
            "volume": {"constraint": "exact"},
        }
    ],
    "driver": {"kind": "relax", "energy_error": 0.5},
    "output": {"every": 1},
}


def test_a_dict_is_the_scene_of_a_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        textwrap.dedent(
            """
            units = "none"
            [[surface]]
            name = "vesicle"
            shape = "ellipsoid:0.8,0.8,1.4"
            vertices = 162
            bending = { method = "gompper-kroll", modulus = 1 }
            area = { constraint = "exact" }
            volume = { constraint = "exact" }
            [driver]
            kind = "relax"
            energy_error = 0.5
            [output]
            every = 1
            """
        )
    )
    first, second = helfrich.run(path), helfrich.run(VESICLE)
    assert first.end == second.end == "converged"
    assert list(first.series) == list(second.series)
    for name, values in first.series.items():
        np.testing.assert_array_equal(values, second.series[name])
        assert values.dtype == np.float64 and values.ndim == 1
    V, F = first.surfaces["vesicle"]
    assert helfrich.check(V, F).area == pytest.approx(first.series["area"][-1], rel=1e-12)
    assert first.folder is None and first.summary["title"] == ""


def test_a_mesh_of_arrays():
    V, F, _ = helfrich.shape("ellipsoid:0.8,0.8,1.4", 162)
    surface = dict(VESICLE["surface"][0], mesh=(V, F))
    del surface["shape"], surface["vertices"]
    run = helfrich.run(dict(VESICLE, surface=[surface]))
    expected = helfrich.run(VESICLE, set={"surface.0.family": "regular"})
    np.testing.assert_array_equal(run.series["energy"], expected.series["energy"])


def test_callback():
    seen = []

    def callback(fraction, message, surfaces):
        seen.append((fraction, message, surfaces["vesicle"]))

    run = helfrich.run(VESICLE, callback=callback)
    assert len(seen) == run.summary["iterations"]
    assert 0 <= seen[0][0] <= seen[-1][0] <= 1
    assert "energy" in seen[0][1]
    np.testing.assert_array_equal(seen[-1][2], run.surfaces["vesicle"][0])
    assert not np.array_equal(seen[0][2], seen[-1][2])
    stopped = helfrich.run(VESICLE, callback=lambda *_: False)
    assert stopped.end == "interrupted" and stopped.summary["iterations"] == 1

    def failing(*_):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        helfrich.run(VESICLE, callback=failing)


def test_a_new_mesh_during_the_run():
    """Positions of the callback and the end have the vertices of the new mesh."""
    scene = {**VESICLE, "surface": [{**VESICLE["surface"][0], "remesh": {"vertices": 300}}]}
    seen = []
    run = helfrich.run(scene, callback=lambda *progress: seen.append(progress[2]["vesicle"]))
    V, F = run.surfaces["vesicle"]
    assert run.series["remeshings"][-1] > 0 and len(V) == len(seen[-1]) == 300
    assert helfrich.check(V, F).problems == [] and F.max() == 299
    np.testing.assert_array_equal(seen[-1], V)


def test_resume(tmp_path):
    steps = []
    helfrich.run(VESICLE, out=tmp_path / "run", callback=lambda *_: steps.append(1) or len(steps) < 4)
    run = helfrich.run(VESICLE, out=tmp_path / "run", resume=True)
    expected = helfrich.run(VESICLE)
    np.testing.assert_array_equal(run.series["energy"], expected.series["energy"])
    assert run.folder == tmp_path / "run" and (run.folder / "summary.json").exists()
    with pytest.raises(ValueError, match="there is a run here already"):
        helfrich.run(VESICLE, out=tmp_path / "run")
    with pytest.raises(ValueError, match="resume"):
        helfrich.run(VESICLE, resume=True)


def test_set():
    run = helfrich.run(VESICLE, set={"surface.vesicle.bending.modulus": 2.0, "output.every": None})
    expected = helfrich.run(VESICLE)
    assert run.series["energy"][0] == pytest.approx(2 * expected.series["energy"][0])


def test_scenes_that_are_wrong():
    with pytest.raises(ValueError, match="no scene of that name"):
        helfrich.run("nonsense")
    with pytest.raises(ValueError, match="bendig"):
        helfrich.run(dict(VESICLE, surface=[dict(VESICLE["surface"][0], bendig={})]))
    with pytest.raises(TypeError, match="cannot be a value"):
        helfrich.run(dict(VESICLE, title=object()))
    with pytest.raises(ValueError):
        helfrich.run(VESICLE, set={"": 1})


def test_scenes_that_come_with_the_package():
    assert "capsule-shear" in helfrich.SCENES
    run = helfrich.run("capsule-shear", set={"surface.0.vertices": 162, "driver.strain": 0.2})
    assert run.end == "completed"
    assert run.series["deformation"][-1] > run.series["deformation"][0]


@pytest.mark.parametrize(
    "call",
    [
        "helfrich.run('capsule-shear', out=folder)",
        "helfrich.recommend(*helfrich.shape('discocyte', 40962)[:2])",
        "[helfrich.curvature(*mesh) for mesh in [helfrich.shape('discocyte', 10242)[:2]] for _ in range(99)]",
    ],
)
def test_ctrl_c(tmp_path, call):
    # A shell that starts this in the background has it ignore the signal.
    heed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    folder = str(tmp_path / "run")
    code = f"{heed}; import helfrich; folder = {folder!r}; print('begin', flush=True); {call}"
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "begin\n"
    time.sleep(1.0)
    start = time.perf_counter()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors
    assert process.returncode in (-signal.SIGINT, 130, 1)
    # One step of each of these takes a few seconds at most, on a machine with other work.
    assert time.perf_counter() - start < 20
    if "run(" in call:
        assert os.path.exists(tmp_path / "run" / "checkpoint")
