"""Meshes made of triangles that are none."""

import numpy as np
import pytest

import helfrich

V, F, _ = helfrich.shape("sphere", 162)


def test_a_valid_mesh_is_the_same():
    repaired = helfrich.repair(V, F)
    assert repaired.actions == {} and "nothing was changed" in repr(repaired)
    np.testing.assert_array_equal(repaired.vertices, V)
    np.testing.assert_array_equal(repaired.faces, F)
    np.testing.assert_array_equal(repaired.vertex_of, np.arange(len(V)))
    np.testing.assert_array_equal(repaired.face_of, np.arange(len(F)))


def test_each_refusal_names_the_function_that_mends_it():
    flipped = F.copy()
    flipped[:50] = flipped[:50, ::-1]
    fin = np.vstack([F, [[F[0, 0], F[0, 1], 77]]])
    # Two spheres with a vertex in common.
    others = np.where(F == 0, 0, F + len(V))[:, ::-1]
    touching = np.vstack([V, [2 * V[0, 0], 0, 0] + V * [-1, 1, 1]])
    unknown = np.vstack([V, [[np.nan, 0, 0]]])
    for vertices, faces, actions in [
        (V, flipped, {"reversed": 50}),
        (V, fin, {"edges": 1}),
        (V, np.vstack([F, F[3:4]]), {"duplicates": 1}),
        (V, np.vstack([F, [[5, 5, 6]]]), {"repeated": 1}),
        (touching, np.vstack([F, others]), {"bow_ties": 1}),
        (unknown, np.vstack([F, [[0, 1, 162]]]), {"not_finite": 1, "unused": 1}),
    ]:
        with pytest.raises(helfrich.MeshError, match=r"helfrich\.repair\(V, F\)"):
            helfrich.curvature(vertices, faces)
        repaired = helfrich.repair(vertices, faces)
        assert {key: repaired.actions.get(key) for key in actions} == actions, repaired
        assert helfrich.check(*repaired).is_mesh
        # The origins lead back.
        np.testing.assert_array_equal(repaired.vertices, vertices[repaired.vertex_of])
        old = np.sort(faces[repaired.face_of], axis=1)
        np.testing.assert_array_equal(np.sort(repaired.vertex_of[repaired.faces], axis=1), old)
        assert helfrich.repair(*repaired).actions == {}


def test_options():
    holed = helfrich.repair(V, F[1:], fill=3)
    assert holed.actions == {"filled": 1} and list(np.flatnonzero(holed.face_of < 0)) == [len(F) - 1]
    soup = np.arange(F.size).reshape(-1, 3)
    assert helfrich.repair(V[F.ravel()], soup).actions == {}
    assert helfrich.repair(V[F.ravel()], soup, weld=1e-9).actions == {"merged": F.size - len(V)}
    assert helfrich.repair(V, F[:, ::-1], outward=True).actions == {"turned": 1}
    more = np.vstack([V, [[9, 9, 9]]])
    assert helfrich.repair(more, F, drop_unused=True).actions == {"unused": 1}
    fin = np.vstack([F, [[F[0, 0], F[0, 1], 162]]])
    assert helfrich.repair(more, fin, sheets="largest").actions == {"small_sheets": 1, "unused": 1}
    needle = np.vstack([V, [V[F[0, 0]] * (1 - 1e-6) + V[F[0, 1]] * 1e-6]])
    faces = np.vstack([F[1:], [[F[0, 0], 162, F[0, 2]], [162, F[0, 1], F[0, 2]], [F[0, 0], F[0, 1], 162]]])
    assert helfrich.repair(needle, faces, slivers=2.0).actions["collapsed"] >= 1
    with pytest.raises(helfrich.MeshError, match="no triangle is left"):
        helfrich.repair(V, [[0, 0, 1]])


def test_files(tmp_path):
    path = tmp_path / "fin.obj"
    helfrich.write(path, V, F)
    path.write_text(path.read_text() + "f 1 1 2\n")
    with pytest.raises(helfrich.MeshError, match=r"fin\.obj.*helfrich\.repair\(path\)"):
        helfrich.read(path)
    repaired = helfrich.repair(path)
    assert repaired.actions == {"repeated": 1}
    np.testing.assert_array_equal(repaired.vertices, V)
