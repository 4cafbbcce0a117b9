"""The smooth surface between the vertices."""

import numpy as np
import pytest

import helfrich


def centres(F):
    return np.arange(len(F)), np.full((len(F), 3), 1 / 3)


def test_points_between_vertices_are_on_the_sphere():
    V, F, _ = helfrich.shape("sphere", 642, family="irregular")
    found = helfrich.surface(2 * V, F, method="j6").at(*centres(F))
    # The largest errors are 2.4e-8 and 4e-7.
    assert abs(np.linalg.norm(found.position, axis=1) - 2).max() < 1e-7
    assert abs(found.H - 0.5).max() < 2e-6
    assert abs(found.K - 0.25).max() < 2e-6
    assert abs(found.position / 2 - found.normal).max() < 1e-5
    assert np.allclose((found.k1 + found.k2) / 2, found.H)
    assert (found.position_error > 0).all() and found.position_error.max() < 1e-5


def test_a_degree_is_chosen_by_the_mesh():
    V, F, _ = helfrich.shape("sphere", 642)
    chosen, sixth = (helfrich.surface(V, F, method=method).at(*centres(F)) for method in ("jet", "j6"))
    assert (chosen.H == sixth.H).all()


def test_projections_are_the_nearest_points():
    V, F, _ = helfrich.shape("ellipsoid:1,0.8,0.5", 2562)
    smooth = helfrich.surface(V, F)
    below = smooth.at(*centres(F))
    faces, weights = smooth.project(below.position + 0.05 * below.normal)
    found = smooth.at(faces, weights)
    assert abs(found.position - below.position).max() < 1e-6
    assert faces.dtype == np.uint32 and abs(weights.sum(axis=1) - 1).max() < 1e-12


def test_vertices_have_the_curvatures_of_the_method():
    V, F, _ = helfrich.shape("discocyte", 642)
    found = helfrich.surface(V, F, method="j6").at(np.arange(len(F)), np.tile([1.0, 0, 0], (len(F), 1)))
    assert abs(found.position - V[F[:, 0]]).max() < 1e-14
    assert abs(found.H - helfrich.curvature(V, F, method="j6").H[F[:, 0]]).max() < 1e-10
    assert (found.position_error == 0).all()


def test_without_a_fit_nothing_is_known():
    V, F = np.eye(3), [[0, 1, 2]]
    found = helfrich.surface(V, F).at([0], [[0.5, 0.25, 0.25]])
    assert found.position.tolist() == [[0.5, 0.25, 0.25]]
    assert found.H[0] == 0 and np.isinf([found.H_error[0], found.position_error[0]]).all()


@pytest.mark.parametrize(
    "faces, weights, text",
    [
        ([20], [[1, 0, 0]], "faces names face 20, but there are 20, numbered from 0"),
        ([-1], [[1, 0, 0]], "faces has to be one-dimensional, with integers of at least 0"),
        ([0.5], [[1, 0, 0]], "faces has to be one-dimensional"),
        ([0, 1], [[1, 0, 0]], "weights has 1 rows, but 2 are needed, one for each of faces"),
        ([0], [[0.5, 0.5, 0.5]], "row 0 of weights is"),
        ([0], [[2, -1, 0]], "row 0 of weights is"),
    ],
)
def test_places_that_are_none_are_refused(faces, weights, text):
    V, F, _ = helfrich.shape("sphere", 12)
    with pytest.raises(ValueError, match=text):
        helfrich.surface(V, F).at(faces, weights)


def test_fields_between_vertices_have_the_order_of_positions():
    V, F, _ = helfrich.shape("torus:1,0.4", 2562, family="irregular")
    smooth = helfrich.surface(V, F)
    faces, weights = np.arange(len(F)), np.full((len(F), 3), 1 / 3)
    values, errors = smooth.interpolate(np.sin(2 * V[:, 0]), faces, weights)
    off = np.abs(values - np.sin(2 * smooth.at(faces, weights).position[:, 0]))
    # Linear interpolation is off by 2e-2.
    assert off.max() < 1e-4
    assert np.mean(off <= errors) > 0.95


def test_points_and_methods_that_are_none_are_refused():
    V, F, _ = helfrich.shape("sphere", 12)
    with pytest.raises(ValueError, match="points"):
        helfrich.surface(V, F).project([[np.nan, 0, 0]])
    with pytest.raises(ValueError, match="'meyer': 'jet', 'j4', 'j6' and 'j8' have a smooth surface"):
        helfrich.surface(V, F, method="meyer")


def test_a_new_mesh_keeps_curvatures_and_fields():
    V, F, exact = helfrich.shape("ellipsoid:1,0.8,0.5", 2562, family="irregular")
    label = (V[:, 0] > 0).astype(float)
    new = helfrich.remesh(V, F, vertices=2000, fields={"z": np.sin(2 * V[:, 2]), "label": label})
    assert len(new.vertices) == 2000 and helfrich.check(new.vertices, new.faces).genus == 0
    flat = np.einsum("nk,nkx->nx", new.weights, V[F[new.face_of]])
    # Triangles with circumscribed circles of 0.06 are 7e-3 below the surface where its radius is 0.25.
    assert abs(flat - new.vertices).max() < 7e-3
    assert abs(new.fields["z"] - np.sin(2 * new.vertices[:, 2])).max() < 1e-5
    assert set(new.fields["label"]) == {0.0, 1.0}
    on = (new.vertices**2 / np.array([1, 0.8, 0.5]) ** 2).sum(1)
    assert abs(on - 1).max() < 1e-6 and new.position_error.max() < 1e-5


def test_a_box_stays_a_box():
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
    sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    faces = [[a, b, c] for s in sides for a, b, c in (s[:3], [s[0], s[2], s[3]])]
    new = helfrich.remesh(corners, faces, edge=0.2)
    found = helfrich.check(new.vertices, new.faces)
    assert found.volume == pytest.approx(1, abs=1e-12) and found.area == pytest.approx(6, abs=1e-12)


def test_noise_is_refused_with_the_remedy():
    V, F, _ = helfrich.shape("sphere", 642, family="irregular")
    V = V + 1e-3 * np.random.default_rng(1).standard_normal(V.shape)
    with pytest.raises(ValueError, match="smooth=True"):
        helfrich.remesh(V, F)
    assert len(helfrich.remesh(V, F, smooth=True).vertices) == 642


def test_noise_is_removed_and_volumes_are_kept():
    V, F, _ = helfrich.shape("sphere", 2562, family="irregular")
    noisy = V + 1e-3 * np.random.default_rng(1).standard_normal(V.shape)
    found = helfrich.smooth(noisy, F)
    before, after = (abs(np.linalg.norm(x, axis=1) - 1).mean() for x in (noisy, found.vertices))
    assert after < before / 3 and found.noise == pytest.approx(1e-3, rel=0.1)
    assert found.degree in (4, 6) and found.scale >= 28
    assert found.volume[1] == pytest.approx(found.volume[0], rel=1e-12)
    assert found.area[0] == pytest.approx(helfrich.check(noisy, F).area, rel=1e-12)
    moved = np.linalg.norm(found.vertices - noisy, axis=1)
    assert found.largest_displacement == pytest.approx(moved.max(), rel=1e-12)
    assert found.displacement == pytest.approx(np.sqrt((moved**2).mean()), rel=1e-12)
    assert (helfrich.smooth(noisy, F, threads=1).vertices == found.vertices).all()


def test_positions_without_noise_keep_their_bits():
    V, F, _ = helfrich.shape("discocyte", 642)
    found = helfrich.smooth(V, F)
    assert (found.vertices == V).all() and (found.noise, found.scale, found.displacement) == (0, 0, 0)


def test_strengths_of_smoothing_are_chosen():
    V, F, _ = helfrich.shape("ellipsoid:1,0.8,0.5", 2562, family="irregular")
    scales = [helfrich.smooth(V, F, scale=scale) for scale in (32, 128)]
    flows = [helfrich.smooth(V, F, flow=time) for time in (1e-4, 1e-2)]
    for weak, strong in (scales, flows):
        assert strong.displacement > 4 * weak.displacement > 0
        assert strong.volume[1] == pytest.approx(strong.volume[0], rel=1e-12)
    assert [found.scale for found in scales] == [32, 128] and flows[0].degree == 0
    with pytest.raises(ValueError, match="scale and flow are given together"):
        helfrich.smooth(V, F, scale=64, flow=1.0)
    with pytest.raises(ValueError, match="choose a time far below this area|smooth less"):
        helfrich.smooth(V, F, flow=1e300)
    flat = helfrich.smooth(V, F[1:], flow=1e-3)
    assert flat.volume is None and (flat.vertices[F[0]] == V[F[0]]).all()
