"""Bending of triangulated membranes.

Functions take positions V (n, 3), float32 or float64, and triangles F (m, 3) of any integer type,
counter-clockwise seen from outside; a mesh of pyvista, trimesh or meshio may take the place of both.

* H = (k1 + k2)/2 is positive on a sphere, and k1 ≥ k2; normals point outward.
* A force is nodal, −∂E/∂x; a force density is a force per area.
* Units are those of the positions and moduli.
* Values are never NaN: where one is unknown, it is 0 and flagged.
* Arguments after V and F are keywords. Results do not depend on the number of threads.
* What is wrong with a mesh is told by `MeshError`, with the face, edge or vertex.
"""

from __future__ import annotations

from . import effects
from ._choices import Recommendation, recommend
from ._curvatures import Curvature, Errors, Flag, curvature, gaussian_curvature, mean_curvature
from ._diffusion import conformal_flow, geodesic_distance
from ._errors import MeshError, MeshWarning
from ._helfrich import METHODS, SCENES, __version__
from ._membranes import Membrane, bending_energy, bending_force
from ._meshes import (
    ComponentReport,
    Exact,
    Part,
    Problem,
    Repaired,
    Report,
    check,
    read,
    repair,
    shape,
    split,
    subdivide,
    weld,
    write,
)
from ._operators import gradient, laplacian
from ._pictures import picture
from ._scenes import Run, run
from ._surfaces import Remeshed, Smoothed, Surface, SurfacePoints, remesh, smooth, surface

__all__ = [
    "METHODS",
    "SCENES",
    "ComponentReport",
    "Curvature",
    "Errors",
    "Exact",
    "Flag",
    "Membrane",
    "MeshError",
    "MeshWarning",
    "Part",
    "Problem",
    "Recommendation",
    "Repaired",
    "Report",
    "Run",
    "Smoothed",
    "Surface",
    "SurfacePoints",
    "__version__",
    "bending_energy",
    "bending_force",
    "check",
    "conformal_flow",
    "curvature",
    "effects",
    "gaussian_curvature",
    "geodesic_distance",
    "gradient",
    "laplacian",
    "mean_curvature",
    "picture",
    "read",
    "recommend",
    "repair",
    "run",
    "shape",
    "split",
    "subdivide",
    "remesh",
    "smooth",
    "surface",
    "weld",
    "write",
]
