"""Compares forces in a dump of LAMMPS with those of the library, bit by bit, and checks the energy in a log.

    python compare.py LIBRARY MESH EFFECTS DUMP LOG
"""

import ctypes
import re
import sys

# The velocity Verlet scheme keeps the energy to its second order in the step: 1e-5 of the energy is an agreement of
# this project for 500 steps of test/in.capsules.
DRIFT = 1e-5


def main(library, mesh, effects, dump, log):
    hf = ctypes.CDLL(library)
    size, pointer = ctypes.c_size_t, ctypes.c_void_p
    hf.hf_mesh_vertex_count.restype = size
    hf.hf_mesh_vertex_count.argtypes = [pointer]

    class Error(ctypes.Structure):
        _fields_ = [("status", ctypes.c_int), ("text", ctypes.c_char * 1020)]

    error = Error()

    def call(function, *arguments):
        status = getattr(hf, function)(*arguments, ctypes.byref(error))
        assert status == 0, error.text.decode()

    handle, membrane = pointer(), pointer()
    call("hf_mesh_read", mesh.encode(), 0, ctypes.byref(handle))
    count = hf.hf_mesh_vertex_count(handle)
    array = ctypes.c_double * (3 * count)
    positions, forces = array(), array()
    call("hf_mesh_positions", handle, positions, size(count))
    text = open(effects, "rb").read()
    call("hf_membrane_new", handle, positions, size(count), text, None, size(0), size(1), ctypes.byref(membrane))

    frames = open(dump).read().split("ITEM: TIMESTEP\n")[1:]
    for frame in frames:
        atoms = [line.split() for line in frame.split("ITEM: ATOMS")[1].splitlines()[1:]]
        assert len(atoms) == 8 * count, len(atoms)
        for start in range(0, len(atoms), count):
            capsule = atoms[start : start + count]
            assert len({atom[1] for atom in capsule}) == 1
            positions[:] = [float(x) for atom in capsule for x in atom[2:5]]
            call("hf_membrane_force", membrane, positions, size(count), forces, None)
            found = [float(x) for atom in capsule for x in atom[8:11]]
            wrong = [k for k in range(3 * count) if found[k] != forces[k]]
            assert not wrong, f"molecule {capsule[0][1]}: {len(wrong)} components of forces differ"
    print(f"forces on {len(frames)} x 8 capsules of {count} vertices equal those of the library")

    rows = [line.split() for line in open(log) if re.match(r" +\d+ +-?\d", line)]
    energies = {int(row[0]): (float(row[1]), float(row[3])) for row in rows}
    elastic, first = energies[0]
    drift = max(abs(total - first) for _, total in energies.values()) / elastic
    print(f"energy drift in {max(energies)} steps: {drift:.1e} of the elastic energy at the start")
    assert max(energies) == 500 and drift < DRIFT, drift


main(*sys.argv[1:])
