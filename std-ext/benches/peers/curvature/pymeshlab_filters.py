"""MeshLab: quadric fitting and discrete curvature."""

import time

import pymeshlab

PACKAGES = ["pymeshlab"]


def peers(np):
    def scalar(mesh, name, choose):
        meshes = pymeshlab.MeshSet(verbose=False)
        meshes.add_mesh(pymeshlab.Mesh(mesh.positions, mesh.triangles.astype(np.int32)))
        results, start = [], time.perf_counter()
        for kind in ("Mean Curvature", "Gaussian Curvature"):
            getattr(meshes, name)(**choose(kind))
            results.append(meshes.current_mesh().vertex_scalar_array())
            # It finds both at once, and shows one of them.
            results.append(time.perf_counter() - start)
        mean, once, gaussian, _ = results
        return {"H": mean, "K": gaussian, "seconds": once}

    def fitted(mesh):
        name = "compute_curvature_principal_directions_per_vertex"
        return scalar(mesh, name, lambda kind: {"method": "Quadric Fitting", "curvcolormethod": kind})

    def discrete(mesh):
        name = "compute_scalar_by_discrete_curvature_per_vertex"
        return scalar(mesh, name, lambda kind: {"curvaturetype": kind})

    yield "pymeshlab quadric fitting", fitted, None
    yield "pymeshlab discrete curvature", discrete, None
