"""trimesh: curvature measures of balls of two edges."""

import rtree  # noqa: F401, trimesh searches neighbours with it
import trimesh

PACKAGES = ["trimesh", "rtree", "scipy"]


def peers(np):
    def measures(mesh):
        body = trimesh.Trimesh(mesh.positions, mesh.triangles, process=False)
        radius = 2 * body.edges_unique_length.mean()
        disc = np.pi * radius**2
        of = trimesh.curvature
        return {
            "H": of.discrete_mean_curvature_measure(body, mesh.positions, radius) / disc,
            "K": of.discrete_gaussian_curvature_measure(body, mesh.positions, radius) / disc,
        }

    # On finer meshes it takes minutes.
    yield "trimesh measures, two edges", measures, 11_000
