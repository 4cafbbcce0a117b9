"""libigl: cotangent operator with Voronoi areas, and quadrics fitted to neighbours at a distance of up to r edges."""

import igl
import scipy  # noqa: F401, igl returns its matrices

PACKAGES = ["libigl", "scipy"]


def peers(np):
    def cotangent(mesh):
        positions, triangles = mesh.positions, mesh.triangles
        area = igl.massmatrix(positions, triangles, igl.MASSMATRIX_TYPE_VORONOI).diagonal()
        vector = -0.5 * (igl.cotmatrix(positions, triangles) @ positions) / area[:, None]
        sign = np.sign((vector * mesh.normal).sum(axis=1))
        gaussian = igl.gaussian_curvature(positions, triangles) / area
        return {"H": sign * np.linalg.norm(vector, axis=1), "K": gaussian}

    def quadric(radius):
        def run(mesh):
            found = igl.principal_curvature(mesh.positions, mesh.triangles, radius, True)
            return {"H": 0.5 * (found[2] + found[3]), "K": found[2] * found[3]}

        return run

    yield "igl cotmatrix, Voronoi", cotangent, None
    for radius in (2, 3, 4):
        yield f"igl principal_curvature r = {radius}", quadric(radius), None
