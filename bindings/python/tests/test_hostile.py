"""Values that no argument can have: each is refused by name, with its limits and what would be right."""

import re

import numpy as np
import pytest

import helfrich
from conftest import rough
from helfrich import effects
from test_docs import functions

V, F = rough(42)
NAN, INF, HUGE = float("nan"), float("inf"), 10**400
LONG, LONE = "x" * 5000, "\ud800"
MASKED = np.ma.array(np.ones(42), mask=np.arange(42) == 3)
SEVERAL = np.ones(3)

# What a whole number, a number, a length, a text, True or False, and a path cannot be.
WHOLE = [-1, 2**70, HUGE, 1.5, NAN, "3", True, SEVERAL, object()]
NUMBER = [NAN, INF, -INF, HUGE, 1j, "1", None, True, SEVERAL, object(), np.ma.masked]
LENGTH = [-1.0, *NUMBER]
LENGTH_OR_NONE = [value for value in LENGTH if value is not None]
TEXT = [3, b"j6", ["j6"], LONG, LONE, "", "nonsense", object()]
FLAG = [1, "no", None, SEVERAL, object()]
PATH = [3, ["a"], "a\0b", object()]
MATERIAL = [NAN, INF, -INF, HUGE, 1j, "1", None, np.ones(41), np.ones((42, 1)), np.full(42, NAN), MASKED, object()]
THREADS = [0, 1025, *WHOLE]
VECTOR = [None, 3.0, "xyz", [1, 2], [1, 2, 3, 4], [1, NAN, 2], [1, "a", 2], object()]
REFERENCE = [None, 3, V[:-1], V[:, :2], np.where(V == V[3, 1], NAN, V), np.ma.array(V, mask=V == V[3, 1]), object()]
TARGET = [NAN, INF, "1", 1j, np.ones(2), np.array([NAN]), object()]
LABELS = [None, np.ones(42), np.arange(41), ["a"] * 42, np.full(42, 2**64 - 1, np.uint64), object()]


def broken_at(vertex):
    """The positions with a number that is none at a vertex."""
    broken = V.copy()
    broken[vertex, 1] = NAN
    return broken


def of_mesh(call, large=V * 1e300):
    """The calls with positions and faces that are none, whose messages name V or F, or the place."""
    broken = broken_at(7)
    huge, wide = F.astype(np.int64), F.astype(np.uint64)
    huge[5, 2], wide[5, 2] = 4294967295, 2**63
    positions = [
        broken, np.where(broken == broken, V, INF), large, V[:, :2], V[0], V[:-1], V.astype(str), V.astype(complex),
        np.ma.array(V, mask=V == V[3, 1]), [[0, 0, 0], [1, 0], [0, 1, 0]], [[HUGE, 0, 0]], object(), 3, "V",
    ]  # fmt: skip
    faces = [
        huge, wide, F.astype(np.int64) - 1, F.astype(float), F[:, :2], F[0], F[:0], F.astype(str), F[:, [0, 0, 1]],
        np.ma.array(F, mask=F == F[3, 1]), [[HUGE, 0, 1]], object(), 3, "F",
    ]  # fmt: skip
    # "a mesh", and the names of its parts, are names, too.
    named = r"\bV\b|vertex|coordinate|positions"
    for value in positions:
        yield named, value, lambda value=value: call(value, F)
    for value in faces:
        yield r"\bF\b|vertex|triangle|face", value, lambda value=value: call(V, value)


def is_repairable(value):
    """Whether positions are wrong in their numbers only."""
    is_array = isinstance(value, np.ndarray) and not isinstance(value, np.ma.MaskedArray)
    return is_array and value.shape == V.shape and value.dtype == V.dtype


def of(name, values, call):
    for value in values:
        yield rf"\b(?:{name})\b", value, lambda value=value: call(value)


def scene(**of_surface):
    surface = {"name": "a", "shape": "sphere", "vertices": 42, "tension": {"value": 1.0}, **of_surface}
    return {"units": "none", "surface": [surface], "driver": {"kind": "relax", "iterations": 1}}


h = helfrich
CALLS = {
    "read": [of("path", [None, *PATH], h.read)],
    "write": [
        of_mesh(lambda V, F: h.write("unwritten.ply", V, F)),
        of("path", [None, *PATH], lambda value: h.write(value, V, F)),
        of("H", [None, V[:-1, 0], MASKED, V.astype(complex), object()], lambda H: h.write("unwritten.vtp", V, F, H=H)),
    ],
    "shape": [
        of("spec|shape", [None, *TEXT], lambda value: h.shape(value, 42)),
        of("sphere", ["sphere:1e-300", "sphere:1e300"], lambda value: h.shape(value, 42)),
        of("discocyte", ["discocyte:1e-150", "discocyte:-1", "discocyte:nan"], lambda value: h.shape(value, 42)),
        of("n|vertices", [0, None, 10**9, *WHOLE], lambda value: h.shape("sphere", value)),
        of("family", [None, *TEXT], lambda value: h.shape("sphere", 42, family=value)),
        of("seed", [None, *WHOLE], lambda value: h.shape("sphere", 42, seed=value)),
    ],
    "weld": [
        # Any finite positions can be welded.
        of_mesh(h.weld, large=broken_at(7)),
        of("distance", LENGTH, lambda value: h.weld(V, F, distance=value)),
    ],
    "repair": [
        # Faces with positions that are not finite are left out.
        [case for case in of_mesh(h.repair, large=V[:3]) if not is_repairable(case[1])],
        of("weld", LENGTH_OR_NONE, lambda value: h.repair(V, F, weld=value)),
        of("sheets", [None, *TEXT], lambda value: h.repair(V, F, sheets=value)),
        of("fill", [None, *WHOLE], lambda value: h.repair(V, F, fill=value)),
        of("slivers", [60.5, *LENGTH], lambda value: h.repair(V, F, slivers=value)),
        of("outward", FLAG, lambda value: h.repair(V, F, outward=value)),
        of("drop_unused", FLAG, lambda value: h.repair(V, F, drop_unused=value)),
        of("V|file|nowhere", [b"nowhere.ply", "nowhere.ply", "a\0b"], h.repair),
    ],
    "curvature": [
        of_mesh(h.curvature),
        of("method", [None, *TEXT], lambda value: h.curvature(V, F, method=value)),
        of("scale", [27, 4097, *WHOLE], lambda value: h.curvature(V, F, scale=value)),
        of("radius", [0.0, *LENGTH_OR_NONE], lambda value: h.curvature(V, F, radius=value)),
        of("sigma", LENGTH, lambda value: h.curvature(V, F, sigma=value)),
        of("directions", FLAG, lambda value: h.curvature(V, F, directions=value)),
        of("errors", FLAG, lambda value: h.curvature(V, F, errors=value)),
        of("areas", TEXT, lambda value: h.curvature(V, F, method="meyer", areas=value)),
        of("bandwidth", [0, -1, INF, "x", [1], LONG], lambda value: h.curvature(V, F, method="D", bandwidth=value)),
        of("threads", THREADS, lambda value: h.curvature(V, F, threads=value)),
    ],
    "mean_curvature": [
        of("method", [None, *TEXT], lambda value: h.mean_curvature(V, F, method=value)),
        of("threads", THREADS, lambda value: h.mean_curvature(V, F, threads=value)),
    ],
    "gaussian_curvature": [
        of("method", [None, *TEXT], lambda value: h.gaussian_curvature(V, F, method=value)),
        of("threads", THREADS, lambda value: h.gaussian_curvature(V, F, threads=value)),
    ],
    "laplacian": [
        of_mesh(h.laplacian),
        of("method|operator", [None, *TEXT], lambda value: h.laplacian(V, F, method=value)),
        of("mass|areas", [None, *TEXT], lambda value: h.laplacian(V, F, mass=value)),
    ],
    "gradient": [of_mesh(h.gradient)],
    "geodesic_distance": [
        of_mesh(lambda V, F: h.geodesic_distance(V, F, sources=0)),
        of("sources", [None, -1, 42, [], [0, 42], True, [True], 0.5, NAN, "a", [[0]], 2**70, object()], lambda value: h.geodesic_distance(V, F, sources=value)),
    ],
    "conformal_flow": [
        of_mesh(h.conformal_flow),
        of("steps", [None, *WHOLE], lambda value: h.conformal_flow(V, F, steps=value)),
        of("time", LENGTH, lambda value: h.conformal_flow(V, F, time=value)),
    ],
    "remesh": [
        of_mesh(h.remesh),
        of("vertices", [3, *WHOLE], lambda value: h.remesh(V, F, vertices=value)),
        of("edge", [0.0, -1.0, NAN, INF, "1", [1.0, 2.0], [[1.0]], object()], lambda value: h.remesh(V, F, edge=value)),
        of("curvature", [0.0, *LENGTH_OR_NONE], lambda value: h.remesh(V, F, curvature=value)),
        of("error", [0.0, *LENGTH_OR_NONE], lambda value: h.remesh(V, F, error=value)),
        of("creases", [0.0, *LENGTH], lambda value: h.remesh(V, F, creases=value)),
        of("smooth", FLAG, lambda value: h.remesh(V, F, smooth=value)),
        of("fields|a", [3, [1], {3: V[:, 0]}, {"a": [1.0]}, {"a": "b"}], lambda value: h.remesh(V, F, fields=value)),
    ],
    "picture": [
        of_mesh(h.picture),
        of("values", [V[:-1, 0], V, V.astype(str), MASKED, np.full(42, NAN), object()], lambda value: h.picture(V, F, values=value)),
        of("error", [V[:-1, 0], V, MASKED, object()], lambda value: h.picture(V, F, values=V[:, 0], error=value)),
        of("directions", [3, V, (V, V[:-1]), (V[:, 0], V), object()], lambda value: h.picture(V, F, directions=value)),
        of("limits|range", [3, (1,), (1, 0), (1, 1), (NAN, 1), ("a", 1)], lambda value: h.picture(V, F, values=V[:, 0], limits=value)),
        of("diverging", [1, "no", SEVERAL], lambda value: h.picture(V, F, diverging=value)),
        of("label", [3, None, b"j6", LONG, LONE, object()], lambda value: h.picture(V, F, label=value)),
        of("title", [3, None, b"j6", LONG, LONE, object()], lambda value: h.picture(V, F, title=value)),
        of("edges", FLAG, lambda value: h.picture(V, F, edges=value)),
        of("view", [[0, 0, 0], [0, 0, 1], *VECTOR], lambda value: h.picture(V, F, view=value)),
        of("up|upwards", [[0, 0, 0], [0.55, -1, 0.62], *VECTOR], lambda value: h.picture(V, F, up=value)),
        of("unit", [3, b"nm", LONG, LONE, object()], lambda value: h.picture(V, F, unit=value)),
        of("size", [3, (159, 200), (4097, 200), (200.5, 200), (200,), object()], lambda value: h.picture(V, F, size=value)),
        of("path", ["picture.jpg", *PATH], lambda value: h.picture(V, F, path=value)),
        of("nowhere", ["nowhere/picture.png"], lambda value: h.picture(V, F, path=value)),
    ],
    "smooth": [
        of_mesh(h.smooth),
        of("scale", [27, 4097, *WHOLE], lambda value: h.smooth(V, F, scale=value)),
        of("flow", [0.0, *LENGTH_OR_NONE], lambda value: h.smooth(V, F, flow=value)),
        of("threads", THREADS, lambda value: h.smooth(V, F, threads=value)),
    ],
    "surface": [
        of_mesh(h.surface),
        of("method", [None, *TEXT], lambda value: h.surface(V, F, method=value)),
        of("faces", [None, -1, 80, 2**70, 0.5, NAN, "a", [[0]]], lambda value: h.surface(V, F).at(value, [[1, 0, 0]])),
        of("weights", [None, [[1, 1, 1]], [[NAN] * 3], [[1, 0]], "a"], lambda value: h.surface(V, F).at([0], value)),
        of("field", [None, [1.0], [NAN] * 42, "a"], lambda value: h.surface(V, F).interpolate(value, [0], [[1, 0, 0]])),
        of("points", [None, [[NAN] * 3], [[INF] * 3], [[1, 0]], "a"], lambda value: h.surface(V, F).project(value)),
    ],
    "bending_energy": [
        of_mesh(h.bending_energy),
        of("kappa|modulus", MATERIAL, lambda value: h.bending_energy(V, F, kappa=value)),
        of("H0|curvature", MATERIAL, lambda value: h.bending_energy(V, F, H0=value)),
        of("method", TEXT, lambda value: h.bending_energy(V, F, method=value)),
        of("areas", TEXT, lambda value: h.bending_energy(V, F, areas=value)),
        of("threads", THREADS, lambda value: h.bending_energy(V, F, threads=value)),
    ],
    "bending_force": [
        of_mesh(h.bending_force),
        of_mesh(lambda V, F: h.bending_force(V, F, density=True)),
        of("kappa|modulus", MATERIAL, lambda value: h.bending_force(V, F, kappa=value, density=True)),
        of("H0|curvature", MATERIAL, lambda value: h.bending_force(V, F, H0=value, density=True)),
        of("method", TEXT, lambda value: h.bending_force(V, F, method=value)),
        of("method", TEXT, lambda value: h.bending_force(V, F, method=value, density=True)),
        of("density", FLAG, lambda value: h.bending_force(V, F, density=value)),
        of("out", [3, [1.0], V.astype(np.float32), V[:-1].copy(), V.T.copy().T], lambda value: h.bending_force(V, F, out=value)),
        of("threads", THREADS, lambda value: h.bending_force(V, F, threads=value, density=True)),
    ],
    "Membrane": [
        of_mesh(lambda V, F: h.Membrane(F, effects.Bending(), vertices=42).force(V)),
        of("F", [np.array([[0, 1, 4294967295]]), np.array([[0, 1, 100]])], h.Membrane),
        of("effect", [None, 3, "bending", effects.Bending, object()], lambda value: h.Membrane(F, value)),
        of("vertices|vertex", [0, 3, 2**40, *WHOLE], lambda value: h.Membrane(F, vertices=value)),
        of("threads", THREADS, lambda value: h.Membrane(F, threads=value)),
    ],
    "split": [of_mesh(h.split)],
    "subdivide": [
        of_mesh(h.subdivide),
        of("levels|triangles|vertices", [33, 32, None, *WHOLE], lambda value: h.subdivide(V, F, levels=value)),
        of("limit", FLAG, lambda value: h.subdivide(V, F, limit=value)),
    ],
    "recommend": [
        of_mesh(lambda V, F: h.recommend(V, F, methods=["meyer"], scalars=["f64"])),
        of("error", [0.0, *LENGTH], lambda value: h.recommend(V, F, error=value)),
        of("quantity|quantities", [None, *TEXT], lambda value: h.recommend(V, F, quantity=value)),
        of("norms?", [None, *TEXT], lambda value: h.recommend(V, F, norm=value)),
        of("methods?", ["j6", 3, [], [None], ["nonsense"], [LONG]], lambda value: h.recommend(V, F, methods=value)),
        of("scalars?|number type", ["f64", 3, [], [None], ["f16"], [LONG]], lambda value: h.recommend(V, F, scalars=value)),
        of("threads", THREADS, lambda value: h.recommend(V, F, methods=["meyer"], threads=value)),
    ],
    "run": [
        of("scene", [None, *PATH], h.run),
        of("set", [3, "a=1", ["a"], object()], lambda value: h.run(scene(), set=value)),
        of("title", [None, object(), LONE], lambda value: h.run({**scene(), "title": value})),
        of(r"surface\.0\.vertices|vertices", [2**70, NAN, None, object()], lambda value: h.run(scene(vertices=value))),
        of(r"surface\.0\.tension\.value|value", [NAN, INF, None, MASKED], lambda value: h.run(scene(tension={"value": value}))),
        of("V|mesh|vertex|coordinate", [object(), (V * NAN, F)], lambda value: h.run(scene(mesh=value))),
        of("out", PATH, lambda value: h.run(scene(), out=value)),
        of("resume", FLAG, lambda value: h.run(scene(), resume=value)),
        of("callback", [3, "a", object()], lambda value: h.run(scene(), callback=value)),
        of("threads", THREADS, lambda value: h.run(scene(), threads=value)),
    ],
    "check": [],
}  # fmt: skip

EFFECTS = {
    "Bending": {"method": [None, *TEXT], "kappa": MATERIAL, "H0": MATERIAL, "areas": TEXT, "bandwidth": [NAN, [1], LONG]},
    "GaussianBending": {"modulus": MATERIAL},
    "NeoHookean": {"shear_modulus": NUMBER, "reference": REFERENCE},
    "Skalak": {"shear_modulus": NUMBER, "area_ratio": NUMBER, "reference": REFERENCE},
    "LocalArea": {"modulus": NUMBER, "reference": REFERENCE},
    "Area": {"modulus": NUMBER, "target": TARGET, "exact": FLAG},
    "Volume": {"modulus": NUMBER, "target": TARGET, "exact": FLAG},
    "AreaDifference": {"modulus": NUMBER, "target": TARGET, "exact": FLAG},
    "Tension": {"value": NUMBER},
    "Pressure": {"value": NUMBER},
    "LineTension": {"value": NUMBER},
    "BorderTension": {"value": NUMBER, "domains": LABELS},
    "Gravity": {"density_difference": NUMBER, "acceleration": VECTOR, "level": VECTOR},
    "Adhesion": {
        "strength": NUMBER, "distance": NUMBER, "range": [0.0, *NUMBER], "wall": VECTOR, "normal": [[0, 0, 0], *VECTOR]
    },
    "Loads": {"vertices": [None, -1, [-1, 0], [42, 0], [2**32, 0], [0.5, 1], ["a", "b"]], "forces": [None, V[:3], [[NAN, 0, 0]] * 2]},
}  # fmt: skip
GOOD = {
    "Bending": {}, "GaussianBending": {"modulus": 1.0}, "NeoHookean": {"shear_modulus": 1.0, "reference": V},
    "Skalak": {"shear_modulus": 1.0, "area_ratio": 1.0, "reference": V}, "LocalArea": {"modulus": 1.0, "reference": V},
    "Area": {"modulus": 1.0, "target": 1.0}, "Volume": {"modulus": 1.0, "target": 1.0},
    "AreaDifference": {"modulus": 1.0, "target": 1.0}, "Tension": {"value": 1.0}, "Pressure": {"value": 1.0},
    "LineTension": {"value": 1.0}, "BorderTension": {"value": 1.0, "domains": np.arange(42)},
    "Gravity": {"density_difference": 1.0, "acceleration": [0, 0, 1]},
    "Adhesion": {"strength": 1.0, "distance": 1.0, "range": 1.0}, "Loads": {"vertices": [0, 1], "forces": V[:2]},
}  # fmt: skip


def refused(named, value, call):
    """A fault of this call, or None if it is refused as it has to be."""
    try:
        call()
    except (ValueError, TypeError, OSError) as error:
        message = str(error)
        if not re.search(named, message):
            return f"does not name {named}: {type(error).__name__}: {message[:300]}"
        # A remedy, or a limit: what is needed, possible, or can be done. Nothing is quoted at length.
        return None if len(message) < 700 else f"has {len(message)} letters"
    except BaseException as error:  # noqa: BLE001, such as OverflowError and AttributeError
        return f"raises {type(error).__name__}: {error}"
    return "is accepted"


def faults(cases):
    found = ((value, refused(named, value, call)) for named, value, call in cases)
    return [f"{value!r:.80}: {fault}" for value, fault in found if fault]


def test_every_function_is_here():
    assert set(CALLS) == set(functions())
    assert set(EFFECTS) == set(GOOD) == set(effects.__all__)


@pytest.mark.parametrize("name", CALLS)
def test_arguments_are_refused_by_name(name, tmp_path, monkeypatch):
    if name in ("laplacian", "gradient", "geodesic_distance", "conformal_flow"):
        pytest.importorskip("scipy")
    monkeypatch.chdir(tmp_path)
    wrong = [fault for cases in CALLS[name] for fault in faults(cases)]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("name", EFFECTS)
def test_keywords_of_effects_are_refused_by_name(name):
    wrong = []
    for keyword, values in EFFECTS[name].items():

        def call(value, keyword=keyword):
            helfrich.Membrane(F, getattr(effects, name)(**{**GOOD[name], keyword: value}))

        words = {"kappa": "kappa|modulus", "H0": "H0|curvature", "domains": "domains|labels", "forces": "forces?|load"}
        found = faults(of(words.get(keyword, keyword.replace("_", "[_ ]")), values, call))
        wrong += [f"{keyword} = {fault}" for fault in found]
    assert not wrong, "\n".join(wrong)


def test_whatever_is_given_a_check_has_problems():
    for _, value, call in of_mesh(helfrich.check):
        assert call().problems, value
