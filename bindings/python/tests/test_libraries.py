"""Meshes of other libraries take the place of V and F, and go round trip."""

import numpy as np
import pytest

import helfrich


@pytest.fixture
def mesh():
    V, F, _ = helfrich.shape("discocyte", 642)
    return V, F


def same(given, mesh):
    """Every function takes the mesh in the place of V and F."""
    V, F = mesh
    expected = helfrich.curvature(V, F).H
    np.testing.assert_array_equal(helfrich.curvature(given).H, expected)
    membrane = helfrich.Membrane(given, helfrich.effects.Bending())
    np.testing.assert_array_equal(membrane.force(given), membrane.force(V))
    assert helfrich.bending_energy(given) == helfrich.bending_energy(V, F)
    assert helfrich.check(given) == helfrich.check(V, F)
    np.testing.assert_array_equal(helfrich.subdivide(given)[0], helfrich.subdivide(V, F)[0])


def test_trimesh(mesh):
    trimesh = pytest.importorskip("trimesh")
    V, F = mesh
    given = trimesh.Trimesh(V, F, process=False)
    same(given, mesh)
    assert type(given.vertices).__name__ == "TrackedArray"
    np.testing.assert_array_equal(helfrich.curvature(given.vertices, given.faces).H, helfrich.curvature(V, F).H)


def test_pyvista(mesh, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    V, F = mesh
    given = pyvista.PolyData.from_regular_faces(V, F)
    same(given, mesh)
    c = helfrich.curvature(given)
    given["H"], given["error of H"] = c.H, c.error.H
    given.save(tmp_path / "theirs.vtp")
    back = helfrich.read(tmp_path / "theirs.vtp")
    np.testing.assert_array_equal(back[0], V)
    np.testing.assert_array_equal(back[1], F)
    helfrich.write(tmp_path / "ours.vtp", given, H=c.H, normal=c.normal)
    read = pyvista.read(tmp_path / "ours.vtp")
    np.testing.assert_array_equal(np.asarray(read.points), V)
    np.testing.assert_array_equal(read["H"], c.H)
    np.testing.assert_array_equal(read["normal"], c.normal)
    same(read, mesh)
    with pytest.raises(helfrich.MeshError, match="triangulate"):
        helfrich.curvature(pyvista.Plane())


def test_three_lines_and_a_picture(mesh, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    mesh = pyvista.PolyData.from_regular_faces(*mesh)
    c = helfrich.curvature(mesh)
    mesh["H"], mesh["error of H"] = c.H, c.error.H
    assert mesh["H"].shape == mesh["error of H"].shape == (642,)
    try:
        mesh.plot(scalars="H", off_screen=True, screenshot=str(tmp_path / "H.png"))
    except Exception as error:
        pytest.skip(f"a picture by pyvista: {error}")
    assert (tmp_path / "H.png").stat().st_size > 1000


@pytest.mark.parametrize("ending", ["ply", "vtp", "obj", "off", "stl"])
def test_files(mesh, tmp_path, ending):
    V, F = mesh
    helfrich.write(tmp_path / f"mesh.{ending}", V, F)
    positions, faces = helfrich.read(tmp_path / f"mesh.{ending}")
    if ending == "stl":
        np.testing.assert_array_equal(positions[faces], V.astype(np.float32)[F])
    else:
        np.testing.assert_array_equal(positions, V)
        np.testing.assert_array_equal(faces, F)
    assert positions.dtype == np.float64 and faces.dtype == np.uint32


@pytest.mark.parametrize("ending", ["ply", "vtp", "obj", "off", "stl"])
def test_meshio(mesh, tmp_path, ending):
    meshio = pytest.importorskip("meshio")
    V, F = mesh
    given = meshio.Mesh(V, [("triangle", F.astype(np.int64))])
    same(given, mesh)
    path = tmp_path / f"mesh.{ending}"
    if ending != "vtp":
        given.write(path)
        positions, faces = helfrich.read(path)
        np.testing.assert_allclose(positions[faces], V[F], rtol=0, atol=1e-6)
    if ending != "vtp":
        helfrich.write(path, V, F)
        read = meshio.read(path)
        np.testing.assert_allclose(read.points[read.cells_dict["triangle"]], V[F], rtol=0, atol=1e-6)


def box(lengths=(1.0, 2.0, 3.0)):
    """A box: its corners, and its sides as polygons, of which one is a concave ledge of two."""
    V = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * lengths
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return V, np.array(quads)


def test_meshio_with_polygons(mesh):
    """Quads and polygons are divided; what has no area is left out; the rest is refused by its name."""
    meshio = pytest.importorskip("meshio")
    V, quads = box()
    triangles = np.concatenate([quads[:3, [0, 1, 2]], quads[:3, [0, 2, 3]]])
    mixed = [("vertex", [[0]]), ("triangle", triangles[:3]), ("line", [[0, 1]]), ("quad", quads[3:]), ("triangle", triangles[3:])]
    for cells in ([("quad", quads)], [("polygon", quads)], mixed):
        report = helfrich.check(meshio.Mesh(V, cells))
        assert (report.problems, report.faces, report.boundary_edges) == ([], 12, 0)
        assert report.volume == pytest.approx(6) and report.area == pytest.approx(22)
    # Half of a sphere by quads, whose triangles are those of the other half.
    ball, F = mesh
    pairs = meshio.Mesh(ball, [("triangle", F[:-2]), ("triangle", F[-2:])])
    assert helfrich.bending_energy(pairs) == helfrich.bending_energy(ball, F)
    # A concave side of an L: ears, not a fan.
    corners = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], float)
    prism = np.concatenate([np.c_[corners, np.zeros(6)], np.c_[corners, np.ones(6)]])
    sides = [[k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6] for k in range(6)]
    for first in range(6):
        ring = np.roll(np.arange(6), first)
        cells = [("polygon", np.array([ring[::-1], ring + 6])), ("quad", np.array(sides))]
        report = helfrich.check(meshio.Mesh(prism, cells))
        assert report.volume == pytest.approx(3) and report.area == pytest.approx(14)
    for kind, count in [("tetra", 4), ("triangle6", 6), ("quad8", 8), ("hexahedron", 8)]:
        cells = [("triangle", triangles), (kind, np.arange(count)[None] % 8)]
        with pytest.raises(helfrich.MeshError, match=f"1 cells of the kind '{kind}'.*remove"):
            helfrich.curvature(meshio.Mesh(V, cells))
    with pytest.raises(helfrich.MeshError, match="no triangles, quads or polygons: its cells are line"):
        helfrich.curvature(meshio.Mesh(V, [("line", [[0, 1]])]))
    with pytest.raises(helfrich.MeshError, match="polygon 1 names vertex 8, but there are 8"):
        helfrich.curvature(meshio.Mesh(V, [("quad", quads + 1)]))


def test_several_meshes_are_joined(mesh):
    """Vertices of the parts follow each other; polygons are divided and lines left out."""
    V, F = mesh
    whole = helfrich.curvature(np.concatenate([V, V + 10]), np.concatenate([F, F + len(V)]), method="C").H
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.Trimesh(V, F, process=False)
    moved = trimesh.transformations.translation_matrix([10, 10, 10])
    scene = trimesh.Scene([ball])
    scene.add_geometry(ball.copy(), transform=moved)
    np.testing.assert_allclose(helfrich.curvature(scene, method="C").H, whole, rtol=1e-9)
    pyvista = pytest.importorskip("pyvista")
    surface = pyvista.PolyData.from_regular_faces(V, F)
    blocks = pyvista.MultiBlock([surface, surface.translate((10, 10, 10))])
    np.testing.assert_allclose(helfrich.curvature(blocks, method="C").H, whole, rtol=1e-9)
    grid = surface.cast_to_unstructured_grid()
    assert (helfrich.curvature(grid, method="C").H == helfrich.curvature(V, F, method="C").H).all()
    box = pyvista.Box(quads=True).clean()
    with_line = box.cast_to_unstructured_grid() + pyvista.Line().cast_to_unstructured_grid()
    assert helfrich.check(with_line).area == pytest.approx(24)
    solid = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    with pytest.raises(helfrich.MeshError, match="8 cells .* type 11: mesh.extract_surface"):
        helfrich.curvature(solid)


def test_objects_that_are_no_surface(mesh):
    """What makes a surface of them is said."""
    trimesh = pytest.importorskip("trimesh")
    with pytest.raises(helfrich.MeshError, match="a PointCloud has points but no faces"):
        helfrich.curvature(trimesh.PointCloud(mesh[0]))


def test_objects_of_pyvista_that_are_no_surface(mesh):
    pyvista = pytest.importorskip("pyvista")
    surface = pyvista.PolyData.from_regular_faces(*mesh)
    strips = surface.strip()
    assert strips.n_strips > 0
    for given, remedy in [
        (pyvista.ImageData(dimensions=(3, 3, 3)), "ImageData is no surface of polygons: mesh.extract_surface"),
        (strips, "strips: mesh.triangulate"),
        (pyvista.Plane(), "polygons: mesh.triangulate"),
    ]:
        with pytest.raises(helfrich.MeshError, match=remedy):
            helfrich.curvature(given)


def test_files_that_cannot_be_read(tmp_path):
    V, F, _ = helfrich.shape("sphere", 42)
    with pytest.raises(FileNotFoundError, match="no such file"):
        helfrich.read(tmp_path / "none.ply")
    with pytest.raises(OSError):
        helfrich.read(tmp_path)
    (tmp_path / "bad.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\n")
    with pytest.raises(helfrich.MeshError, match="bad.obj") as caught:
        helfrich.read(tmp_path / "bad.obj")
    assert caught.value.face == 1 or caught.value.edge is not None
    with pytest.raises(ValueError, match="unknown format"):
        helfrich.write(tmp_path / "mesh.xyz", V, F)
    with pytest.raises(ValueError, match="vtp"):
        helfrich.write(tmp_path / "mesh.ply", V, F, H=V[:, 0])
    with pytest.raises(helfrich.MeshError, match="the field H"):
        helfrich.write(tmp_path / "mesh.vtp", V, F, H=V[:-1, 0])
    with pytest.raises(OSError):
        helfrich.write(tmp_path / "none" / "mesh.ply", V, F)
