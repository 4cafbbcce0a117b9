"""Writes a spherical capsule of 642 vertices and radius 2: the mesh capsule.off, whose positions are the stress-free
reference, and the molecule capsule.mol, with the same vertices as atoms.

    python capsule.py FOLDER
"""

import math
import pathlib
import sys

RADIUS = 2.0


def icosphere(levels):
    """Vertices on the unit sphere and triangles, counter-clockwise seen from outside."""
    golden = (1 + math.sqrt(5)) / 2
    vertices = [(s * a, t * b, 0.0) for a, b in [(1.0, golden)] for s in (-1, 1) for t in (-1, 1)]
    vertices = [tuple(v[(k + turn) % 3] for k in range(3)) for turn in range(3) for v in vertices]
    edge = 2.0
    near = lambda a, b: abs(math.dist(vertices[a], vertices[b]) - edge) < 1e-9
    faces = []
    for a in range(12):
        for b in range(a + 1, 12):
            for c in range(b + 1, 12):
                if near(a, b) and near(b, c) and near(a, c):
                    (x, y, z), u, v = vertices[a], vertices[b], vertices[c]
                    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
                    outward = x * normal[0] + y * normal[1] + z * normal[2] > 0
                    faces.append((a, b, c) if outward else (a, c, b))
    for _ in range(levels):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(vertices)
                vertices.append(tuple((p + q) / 2 for p, q in zip(vertices[a], vertices[b])))
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    unit = lambda v: tuple(x / math.hypot(*v) for x in v)
    return [unit(v) for v in vertices], faces


def main(folder):
    vertices, faces = icosphere(3)
    rows = [" ".join(repr(RADIUS * x) for x in v) for v in vertices]
    corners = [f"3 {a} {b} {c}" for a, b, c in faces]
    off = ["OFF", f"{len(rows)} {len(corners)} 0", *rows, *corners]
    molecule = ["a capsule", "", f"{len(rows)} atoms", "", "Coords", ""]
    molecule += [f"{k} {row}" for k, row in enumerate(rows, 1)]
    molecule += ["", "Types", "", *(f"{k} 1" for k in range(1, len(rows) + 1))]
    folder = pathlib.Path(folder)
    (folder / "capsule.off").write_text("\n".join(off) + "\n")
    (folder / "capsule.mol").write_text("\n".join(molecule) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
