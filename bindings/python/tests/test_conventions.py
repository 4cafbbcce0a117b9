"""Signs, factors and values of curvatures on a sphere, beside those of other libraries: the table of the guide."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import helfrich

GUIDE = Path(__file__).resolve().parents[3] / "docs" / "PYTHON.md"
RADIUS = 2.0

# What the cells of the table say, for a sphere of radius R and the area A of each vertex.
CELLS = {
    "1/R": lambda R, A: 1 / R,
    "−1/R": lambda R, A: -1 / R,
    "2A/R": lambda R, A: 2 * A / R,
    "−2A/R": lambda R, A: -2 * A / R,
    "1/R²": lambda R, A: 1 / R**2,
    "A/R²": lambda R, A: A / R**2,
}


@pytest.fixture(scope="module")
def sphere():
    """An icosphere, its outward normals, and the areas of its vertices."""
    V, F, exact = helfrich.shape(f"sphere:{RADIUS}", 642)
    return V, F.astype(np.int64), exact.normal, helfrich.curvature(V, F, method="meyer").area


@pytest.fixture(scope="module")
def cgal(sphere, tmp_path_factory):
    """The curvatures of CGAL by their names in cgal.cpp. HELFRICH_CGAL may name folders of headers."""
    compiler = os.environ.get("CXX") or shutil.which("c++")
    if compiler is None:
        pytest.skip("CGAL: there is no C++ compiler")
    folder = tmp_path_factory.mktemp("cgal")
    named = [Path(name) for name in os.environ.get("HELFRICH_CGAL", "").split(os.pathsep) if name]
    eigen = Path("/usr/include/eigen3")
    headers = [word for place in [*named, eigen] if place.is_dir() for word in ("-I", str(place))]
    header = "#include <CGAL/version.h>\n#include <Eigen/Core>\n"
    there = [compiler, "-std=c++17", "-x", "c++", "-E", "-", *headers]
    if subprocess.run(there, input=header, capture_output=True, text=True).returncode != 0:
        pytest.skip("CGAL: its headers, or those of Eigen, are not there")
    source, program = Path(__file__).with_name("cgal.cpp"), folder / "cgal"
    subprocess.run(
        [compiler, "-std=c++17", "-w", "-DCGAL_EIGEN3_ENABLED", *headers, source, "-o", program], check=True
    )
    V, F = sphere[:2]
    helfrich.write(folder / "sphere.off", V, F)
    printed = subprocess.run([program, folder / "sphere.off"], check=True, capture_output=True, text=True)
    names, *rows = printed.stdout.splitlines()
    columns = np.array([row.split() for row in rows], float).T
    assert columns.shape[1] == len(V)
    return dict(zip(names.split(), columns))


def of_cgal(kind):
    def found(sphere, request):
        columns = request.getfixturevalue("cgal")
        if kind == "jet":
            return 0.5 * (columns["jet_k0"] + columns["jet_k1"]), columns["jet_k0"] * columns["jet_k1"]
        if f"{kind}_H" not in columns:
            pytest.skip(f"CGAL: this version has no {kind} curvatures")
        return columns[f"{kind}_H"], columns[f"{kind}_K"]

    return found


def ours(sphere, request):
    found = helfrich.curvature(*sphere[:2])
    return found.H, found.K


def our_laplacian(sphere, request):
    pytest.importorskip("scipy")
    V, F, normal, _ = sphere
    return (normal * (helfrich.laplacian(V, F)[0] @ V)).sum(axis=1), None


def principal_of_libigl(sphere, request):
    first, second = pytest.importorskip("igl").principal_curvature(*sphere[:2])[2:4]
    return 0.5 * (first + second), first * second


def defects_of_libigl(sphere, request):
    return None, pytest.importorskip("igl").gaussian_curvature(*sphere[:2])


def laplacian_of_libigl(sphere, request):
    V, F, normal, _ = sphere
    return (normal * (pytest.importorskip("igl").cotmatrix(V, F) @ V)).sum(axis=1), None


def of_pyvista(sphere, request):
    mesh = pytest.importorskip("pyvista").PolyData.from_regular_faces(*sphere[:2])
    return mesh.curvature("mean"), mesh.curvature("gaussian")


def defects_of_trimesh(sphere, request):
    return None, pytest.importorskip("trimesh").Trimesh(*sphere[:2], process=False).vertex_defects


MEASURED = {
    "helfrich `curvature`": ours,
    "helfrich `laplacian`: n · (L x)": our_laplacian,
    "libigl `principal_curvature`": principal_of_libigl,
    "libigl `gaussian_curvature`": defects_of_libigl,
    "libigl `cotmatrix`: n · (L x)": laplacian_of_libigl,
    "CGAL `interpolated_corrected_curvatures`": of_cgal("corrected"),
    "CGAL `discrete_mean_curvature`, `discrete_Gaussian_curvature`": of_cgal("discrete"),
    "CGAL `Monge_via_jet_fitting`": of_cgal("jet"),
    "pyvista `curvature`": of_pyvista,
    "trimesh `vertex_defects`": defects_of_trimesh,
}


def table():
    """The cells of H and K of each library in the guide."""
    rows = re.findall(r"^\| (.*?) \| (.*?) \| (.*?) \| .* \|$", GUIDE.read_text(encoding="utf-8"), re.M)
    return {name: cells for name, *cells in rows if name in MEASURED}


def test_the_table_of_the_guide_is_whole():
    assert list(table()) == list(MEASURED)


@pytest.mark.parametrize("name", MEASURED)
def test_signs_and_factors_on_a_sphere(name, sphere, request):
    for found, cell in zip(MEASURED[name](sphere, request), table()[name]):
        if cell == "–":
            assert found is None
            continue
        # A tenth of its value, for the square twice that, is the error of libigl's paraboloids over five rings,
        # two fifths of this sphere. Other signs and factors are farther away.
        wanted = np.broadcast_to(CELLS[cell](RADIUS, sphere[3]), found.shape)
        np.testing.assert_allclose(found, wanted, rtol=0.3)


def test_values_of_libigl(sphere):
    """The same formulas have the same values, to rounding."""
    igl = pytest.importorskip("igl")
    pytest.importorskip("scipy")
    V, F = sphere[:2]
    found = helfrich.curvature(V, F, method="meyer")
    np.testing.assert_allclose(igl.gaussian_curvature(V, F) / found.area, found.K, rtol=1e-9)
    L, M = helfrich.laplacian(V, F, mass="voronoi")
    # The opposite sign: libigl's is negative semidefinite.
    np.testing.assert_allclose((L + igl.cotmatrix(V, F)).toarray(), 0, atol=1e-12)
    areas = igl.massmatrix(V, F, igl.MASSMATRIX_TYPE_VORONOI)
    np.testing.assert_allclose(M.diagonal(), areas.diagonal(), rtol=1e-12)
    G, theirs = helfrich.gradient(V, F), igl.grad(V, F)
    u = V[:, 0] * V[:, 1]
    np.testing.assert_allclose((G @ u).reshape(-1, 3), (theirs @ u).reshape(3, -1).T, atol=1e-12)


def test_discrete_curvatures_of_cgal(sphere, request):
    """The same formulas have the same values, to rounding: K by angle defects, H half the length of Δx."""
    pytest.importorskip("scipy")
    H, K = of_cgal("discrete")(sphere, request)
    V, F = sphere[:2]
    found = helfrich.curvature(V, F, method="meyer")
    np.testing.assert_allclose(found.K, K, rtol=1e-9)
    L, M = helfrich.laplacian(V, F, mass="voronoi")
    np.testing.assert_allclose(np.linalg.norm(L @ V, axis=1) / (2 * M.diagonal()), H, rtol=1e-9)
    # Ours is the part along the normal, which is off by a share of h²: h is 0.15 radii.
    np.testing.assert_allclose(found.H, H, rtol=0.15**4)


def test_jets_of_cgal(sphere, request):
    """Both are jets of degree 4 with an error of the order of h³ in H and K: h is 0.15 radii here."""
    H, K = of_cgal("jet")(sphere, request)
    found = helfrich.curvature(*sphere[:2], method="j4")
    np.testing.assert_allclose(found.H, -H, rtol=0.15**3)
    np.testing.assert_allclose(found.K, K, rtol=2 * 0.15**3)
