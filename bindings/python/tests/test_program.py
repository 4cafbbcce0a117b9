"""Every result has the bits of the program's."""

import csv
import io
import json

import numpy as np
import pytest

import helfrich
from conftest import rough

METHODS = [method["name"] for method in helfrich.METHODS]


def columns(text):
    rows = list(csv.reader(io.StringIO(text)))
    of = {name: [row[place] for row in rows[1:]] for place, name in enumerate(rows[0])}
    # Fields are empty where a value is unknown; Python has 0 there, and infinite error bars.
    unknown = {name: "inf" if name.endswith("_error") else "0" for name in of}
    return {
        name: np.array([float(value or unknown[name]) for value in values])
        for name, values in of.items()
        if name != "verdict"
    }


def vectors(found, names):
    return np.stack([found[name] for name in names], axis=1)


def compare(program, path, mesh, method, *, single=False, errors=False, extent={}, kappa=1.0):
    V, F = mesh
    helfrich.write(path, V, F)
    arguments = ["curvature", path, "--method", method, "--modulus", kappa]
    arguments += ["--scalar", "f32"] * single + ["--errors"] * errors
    arguments += [part for name, value in extent.items() for part in (f"--{name}", value)]
    expected = columns(program(*arguments))
    V = V.astype(np.float32) if single else V
    kind = V.dtype.type

    def equal(values, name):
        wanted = expected[name] if isinstance(name, str) else vectors(expected, name)
        np.testing.assert_array_equal(values, wanted.astype(kind), str(name))
        assert values.dtype == kind

    described = next(m for m in helfrich.METHODS if m["name"] == method)
    if described["has_force"]:
        f = helfrich.bending_force(V, F, method=method, density=True, kappa=kappa)
        if not (errors or extent):
            equal(f, ["fx", "fy", "fz"])
    if not described["defines"][0]:
        return
    directions = method == "jet"
    found = helfrich.curvature(V, F, method=method, errors=errors, directions=directions, **extent)
    equal(found.H, "H")
    equal(found.normal, ["nx", "ny", "nz"])
    equal(found.area, "area")
    if found.K is not None:
        equal(found.K, "K")
    if found.error is not None and kappa == 1.0:
        equal(found.k1, "k1")
        equal(found.k2, "k2")
        for name in found.error._fields:
            # A force density of single precision is compared with that of double precision.
            if np.isfinite(expected[f"{name}_error"]).all():
                equal(getattr(found.error, name), f"{name}_error")
    if directions:
        equal(found.d1, [f"direction1_{axis}" for axis in "xyz"])
        equal(found.d2, [f"direction2_{axis}" for axis in "xyz"])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("single", [False, True])
def test_curvatures(program, tmp_path, method, single):
    mesh = rough(642, "discocyte", 1e-3)
    compare(program, tmp_path / "mesh.ply", mesh, method, single=single, kappa=1.0 if single else 0.3)


@pytest.mark.parametrize("method", ["jet", "meyer"])
def test_error_bars(program, tmp_path, method):
    mesh = rough(642, "discocyte", 1e-3)
    compare(program, tmp_path / "mesh.ply", mesh, method, errors=method != "jet")


@pytest.mark.parametrize("extent", [{"scale": 60}, {"radius": 0.25}])
def test_the_extent_of_fits(program, tmp_path, extent):
    compare(program, tmp_path / "mesh.ply", rough(642, "torus", 1e-3), "jet", extent=extent)


@pytest.mark.parametrize("method", ["gompper-kroll", "j4"])
def test_a_mesh_that_is_reordered(program, tmp_path, method):
    compare(program, tmp_path / "mesh.ply", rough(20500, "discocyte", 1e-4), method)


def test_an_open_mesh(program, tmp_path):
    V, F, _ = helfrich.shape("discocyte", 2562)
    F = F[(V[F, 2] > 0).all(axis=1)]
    used, F = np.unique(F, return_inverse=True)
    mesh = V[used], F.reshape(-1, 3)
    for method in ["meyer", "j6", "jet"]:
        compare(program, tmp_path / "mesh.ply", mesh, method)


def test_a_run(program, tmp_path):
    settings = {"surface.0.vertices": 162, "driver.strain": 0.4, "output.slice": None}
    arguments = [f"{key}={'' if value is None else value}" for key, value in settings.items()]
    sets = [word for argument in arguments for word in ("--set", argument)]
    program("run", "capsule-shear", "--out", tmp_path / "own", *sets)
    run = helfrich.run("capsule-shear", set=settings, out=tmp_path / "python")
    own, python = ((tmp_path / name / "series.csv").read_bytes() for name in ("own", "python"))
    assert own == python
    for name, values in columns(own.decode()).items():
        np.testing.assert_array_equal(run.series[name], values)
    unkept = helfrich.run("capsule-shear", set=settings)
    for name, values in run.series.items():
        np.testing.assert_array_equal(unkept.series[name], values)
    V, F = run.surfaces["capsule"]
    last = sorted((tmp_path / "own" / "surfaces").glob("*.vtp"))[-1]
    np.testing.assert_array_equal(V, helfrich.read(last)[0])


def test_energies_and_forces_of_a_scene(program, tmp_path):
    """The effects of a membrane are those of a scene: energies in the first row of its series."""
    V, F, _ = helfrich.shape("ellipsoid:1,1,0.7", 642)
    helfrich.write(tmp_path / "cell.ply", V, F)
    scene = {
        "units": "none",
        "surface": [
            {
                "name": "cell",
                "mesh": str(tmp_path / "cell.ply"),
                "bending": {"method": "j6", "modulus": 0.2, "spontaneous_curvature": 0.1},
                "elasticity": {"law": "skalak", "shear_modulus": 5.3, "area_ratio": 10},
                "area": {"modulus": 3, "target": 8.0},
                "volume": {"modulus": 2, "target": 2.0},
                "area_difference": {"modulus": 0.1, "target": 12.0},
                "tension": {"value": 0.3},
                "pressure": {"value": 0.4},
            }
        ],
        "driver": {"kind": "relax", "iterations": 1},
    }
    run = helfrich.run(scene)
    e = helfrich.effects
    effects = {
        "bending": e.Bending("j6", 0.2, 0.1),
        "elasticity": e.Skalak(5.3, 10, V),
        "area": e.Area(3, 8.0),
        "volume": e.Volume(2, 2.0),
        "area_difference": e.AreaDifference(0.1, 12.0),
        "tension": e.Tension(0.3),
        "pressure": e.Pressure(0.4),
    }
    for name, effect in effects.items():
        energy = helfrich.Membrane(F, effect).energy(V)
        assert energy == run.series[f"energy_{name}"][0], name


def test_recommendations(program, tmp_path):
    V, F = rough(642, "discocyte", 1e-4)
    helfrich.write(tmp_path / "mesh.ply", V, F)
    names = "B,meyer,j4,j6"
    text = program("recommend", tmp_path / "mesh.ply", "--quantity", "H", "--method", names, "--json", "-")
    expected = {(c["method"], c["scalar"]): c["expected"] for c in json.loads(text)["candidates"]}
    found = helfrich.recommend(V, F, quantity="H", methods=names.split(","))
    assert {(c["method"], c["scalar"]): c["expected"] for c in found.candidates} == expected
