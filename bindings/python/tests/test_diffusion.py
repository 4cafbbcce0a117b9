"""Distances along a surface, and the flow of a surface to a sphere."""

import numpy as np
import pytest

import helfrich
from conftest import part

pytest.importorskip("scipy")


def mean_edge(V, F):
    return np.sqrt(4 * helfrich.check(V, F).area / (np.sqrt(3) * len(F)))


def arcs(V, sources):
    """Distances on the unit sphere."""
    return np.arccos(np.clip(V @ V[sources].T, -1, 1)).min(axis=1)


@pytest.mark.parametrize("family, edges", [("regular", 0.5), ("relaxed", 0.5), ("irregular", 1.5)])
def test_distances_on_a_sphere(family, edges):
    """In edges: the time of the heat is the square of one, so that directions see the pattern of the mesh."""
    errors = []
    for n in (642, 2562):
        V, F, _ = helfrich.shape("sphere", n, family=family)
        found = helfrich.geodesic_distance(V, F, sources=0)
        errors.append(abs(found - arcs(V, [0])).max())
        assert errors[-1] < edges * mean_edge(V, F)
        several = [0, n // 3, n // 2]
        found = helfrich.geodesic_distance(V, F, sources=several)
        # Where fronts meet, heat of both sides mixes within an edge or two.
        assert abs(found - arcs(V, several)).max() < 3 * mean_edge(V, F)
        assert (found[several] == 0).all()
    # First order would be a half.
    assert errors[1] < 0.65 * errors[0]


def test_distances_on_an_open_surface():
    """From a source off the pole of a hemisphere, whose borders are geodesics: those of the sphere."""
    V, F, _ = helfrich.shape("sphere", 2562, family="relaxed")
    V, F = part(V, F, V[:, 2] > 0)
    source = int((V[:, 0] + V[:, 2]).argmax())
    found = helfrich.geodesic_distance(V, F, sources=source)
    # With insulated boundaries alone 0.74 edges.
    assert abs(found - arcs(V, [source])).max() < 0.5 * mean_edge(V, F)


def strip(n):
    """A flat strip, one unit wide, with n edges along it."""
    x = np.arange(n + 1.0)
    k, upper = np.arange(n), np.arange(n) + n + 1
    V = np.concatenate([np.c_[x, 0 * x, 0 * x], np.c_[x, 0 * x + 1, 0 * x]])
    return V, np.concatenate([np.c_[k, k + 1, upper], np.c_[k + 1, upper + 1, upper]])


def test_distances_over_more_edges_than_heat_can_cross():
    """exp(−x) is too small for numbers from 745 edges on. Between parallel fronts distances are exact."""
    V, F = strip(1000)
    found = helfrich.geodesic_distance(V, F, sources=[0, 1001])
    np.testing.assert_allclose(found, V[:, 0], rtol=0, atol=1e-6)


def test_distances_in_components():
    V, F, _ = helfrich.shape("sphere", 162)
    alone = helfrich.geodesic_distance(V, F, sources=3)
    both, faces = np.concatenate([V, 1e3 * V, [[0, 0, 7]]]), np.concatenate([F, F + 162])
    found = helfrich.geodesic_distance(both, faces, sources=3)
    np.testing.assert_allclose(found[:162], alone, rtol=1e-12)
    assert np.isinf(found[162:]).all()
    found = helfrich.geodesic_distance(both, faces, sources=[3, 165, 324])
    # Each component has a time and units of its own.
    np.testing.assert_allclose(found[:324], np.concatenate([alone, 1e3 * alone]), rtol=1e-9)
    assert found[324] == 0
    np.testing.assert_allclose(helfrich.geodesic_distance(1e-60 * V, F, sources=3), 1e-60 * alone, rtol=1e-9)


def dilatations(V, x, F):
    """The ratio of the singular values of the map of each triangle, 1 where it is conformal."""

    def inverse_frame(V):
        a, b, c = (V[F[:, corner]] for corner in range(3))
        along = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
        up = c - a - along * ((c - a) * along).sum(axis=1, keepdims=True)
        up /= np.linalg.norm(up, axis=1, keepdims=True)
        return np.array([[(s * t).sum(axis=1) for s in (b - a, c - a)] for t in (along, up)]).transpose(2, 0, 1)

    singular = np.linalg.svd(inverse_frame(x) @ np.linalg.inv(inverse_frame(V)), compute_uv=False)
    return singular[:, 0] / singular[:, 1]


@pytest.mark.parametrize("spec", ["ellipsoid:1,0.8,0.5", "discocyte"])
def test_a_cell_becomes_a_sphere_and_angles_stay(spec):
    found = []
    for n in (642, 2562):
        V, F, _ = helfrich.shape(spec, n, family="relaxed")
        V = V + [3.0, -1.0, 0.5]
        x = helfrich.conformal_flow(V, F)
        before, after = helfrich.check(V, F), helfrich.check(x, F)
        assert after.area == pytest.approx(before.area, rel=1e-12)
        radius = np.linalg.norm(x - [3.0, -1.0, 0.5], axis=1)
        dilatation = dilatations(V, x, F)
        found.append([np.ptp(radius) / radius.mean(), dilatation.mean() - 1])
        # The map along rays to a sphere changes angles more.
        rays = (V - [3.0, -1.0, 0.5]) / np.linalg.norm(V - [3.0, -1.0, 0.5], axis=1, keepdims=True)
        assert dilatation.max() < 1.1 and dilatations(V, rays, F).max() > 1.25
    (spread, distortion), (finer_spread, finer_distortion) = found
    # Second and first order in the edges, which are halved: a quarter and a half.
    assert spread < 0.02 and finer_spread < 0.4 * spread
    assert distortion < 0.05 and finer_distortion < 0.6 * distortion


def test_components_flow_alone():
    V, F, _ = helfrich.shape("ellipsoid:1,0.8,0.5", 162)
    alone = helfrich.conformal_flow(V, F, steps=5)
    both = np.concatenate([V, 1e3 * V + 1e4, [[0, 0, 7]]])
    x = helfrich.conformal_flow(both, np.concatenate([F, F + 162]), steps=5)
    np.testing.assert_allclose(x[:324], np.concatenate([alone, 1e3 * alone + 1e4]), rtol=1e-8)
    np.testing.assert_array_equal(x[324], [0, 0, 7])
    np.testing.assert_array_equal(helfrich.conformal_flow(V, F, steps=0), V)


def test_surfaces_that_are_no_sphere_are_refused():
    V, F, _ = helfrich.shape("torus", 600)
    with pytest.raises(helfrich.MeshError, match="vertex 0 has handles.*genus 0"):
        helfrich.conformal_flow(V, F)
    V, F, _ = helfrich.shape("sphere", 162)
    with pytest.raises(helfrich.MeshError, match="has a boundary.*genus 0") as caught:
        helfrich.conformal_flow(V, F[1:])
    assert caught.value.vertex in F[0]
    with pytest.raises(helfrich.MeshError, match="without area.*repair"):
        helfrich.geodesic_distance(np.zeros_like(V), F, sources=0)
