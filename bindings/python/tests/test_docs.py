"""The table of functions, docstrings, stubs and the guide."""

import ast
import contextlib
import doctest
import importlib.util
import inspect
import io
import os
import pkgutil
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import helfrich
from helfrich import _helfrich, effects

ROOT = Path(__file__).resolve().parents[3]
GUIDE = ROOT / "docs" / "PYTHON.md"


@pytest.fixture(scope="module")
def table():
    tomllib = pytest.importorskip("tomllib" if sys.version_info >= (3, 11) else "tomli")
    return tomllib.loads((ROOT / "bindings" / "functions.toml").read_text(encoding="utf-8"))


def functions():
    named = {name: getattr(helfrich, name) for name in helfrich.__all__}
    return {
        name: value
        for name, value in named.items()
        if inspect.isroutine(value) or name == "Membrane"
    }


def test_the_table_has_every_function_and_the_package_what_the_table_has(table):
    listed = {entry["name"]: entry for entry in table["function"]}
    assert len(listed) == len(table["function"])
    for name, entry in listed.items():
        assert entry["summary"], name
        assert ("python" in entry) != ("python_absent" in entry), name
        assert ("c" in entry) != ("c_absent" in entry), name
        assert "python" not in entry or hasattr(helfrich, entry["python"]), name
    assert set(functions()) <= {entry.get("python") for entry in listed.values()}
    assert len(functions()) == 24


def test_the_table_has_the_symbols_of_the_header(table):
    header = ROOT / "bindings" / "c" / "include" / "helfrich.h"
    if not header.exists():
        pytest.skip("the C interface: there is none")
    declared = set(re.findall(r"\b(hf_\w+)\s*\(", header.read_text(encoding="utf-8")))
    listed = {symbol for entry in table["function"] for symbol in entry.get("c", [])}
    assert listed == declared


def test_the_table_has_every_effect(table):
    listed = {entry["name"]: entry for entry in table["effect"]}
    assert list(listed) == _helfrich.EFFECTS
    classes = [name for entry in listed.values() for name in entry.get("python", [])]
    assert sorted(classes) == effects.__all__
    assert all(("python" in entry) != ("python_absent" in entry) for entry in listed.values())


def test_the_table_has_every_type_of_the_core(table):
    """What the core gains has a function of the bindings, or a reason why not."""
    text = (ROOT / "core" / "src" / "lib.rs").read_text(encoding="utf-8")
    exports = re.findall(r"^pub use [\w:]+::(?:\{([^}]*)\}|(\w+));", text, re.M)
    names = {name.strip() for group, one in exports for name in (group or one).split(",")} - {""}
    names |= set(re.findall(r"^pub mod (\w+);", text, re.M))
    entries = table["function"] + table["effect"] + table["inside"]
    listed = [name for entry in entries for name in entry.get("core", [])]
    assert len(listed) == len(set(listed))
    assert set(listed) == names


def test_every_function_has_documentation_that_runs():
    runner = doctest.DocTestRunner()
    finder = doctest.DocTestFinder()
    names = [module.name for module in pkgutil.iter_modules(helfrich.__path__)]
    for name in names:
        # Examples for PyTorch and JAX need these.
        if name == "_helfrich" or (name in ("jax", "torch") and importlib.util.find_spec(name) is None):
            continue
        module = importlib.import_module(f"helfrich.{name}")
        for test in finder.find(module, f"helfrich.{name}"):
            runner.run(test)
    parsed = doctest.DocTestParser().get_doctest(helfrich.Membrane.__doc__, {}, "Membrane", None, 0)
    runner.run(parsed)
    assert runner.summarize().failed == 0
    for name, function in functions().items():
        text = inspect.getdoc(function)
        assert ">>>" in text, name
        sections = ["Returns", "Raises"] if name not in ("mean_curvature", "gaussian_curvature", "check") else []
        if name in ("laplacian", "gradient", "write", "Membrane", "bending_energy"):
            sections = ["Raises"]
        for section in sections:
            assert section in text, (name, section)
    for name in effects.__all__:
        assert len(inspect.getdoc(getattr(effects, name))) > 40
    for name in ("energy", "force", "energy_and_force", "flags"):
        assert "V (n, 3)" in getattr(helfrich.Membrane, name).__doc__ or name == "energy_and_force"


def test_annotations_and_stubs():
    folder = Path(helfrich.__file__).parent
    assert (folder / "py.typed").exists()
    stub = ast.parse((folder / "_helfrich.pyi").read_text(encoding="utf-8"))
    declared = {}
    for node in stub.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            declared[node.name] = node
        elif isinstance(node, ast.AnnAssign):
            declared[node.target.id] = node
    there = {name for name in dir(_helfrich) if not name.startswith("_") or name == "__version__"}
    assert there == set(declared) - {"_Mended", "_Mesh", "_Sparse"}
    for name in there:
        if isinstance(declared[name], ast.FunctionDef):
            arguments = declared[name].args
            stubbed = [argument.arg for argument in arguments.args + arguments.kwonlyargs]
            assert stubbed == list(inspect.signature(getattr(_helfrich, name)).parameters), name
    methods = {node.name for node in declared["Membrane"].body} - {"__new__", "__getnewargs_ex__"}
    assert methods == {name for name in dir(helfrich.Membrane) if not name.startswith("_")}
    for name, function in functions().items():
        if name == "Membrane":
            continue
        parameters = inspect.signature(function).parameters.values()
        assert all(p.annotation is not inspect.Parameter.empty for p in parameters), name
        # Keywords after V and F.
        positional = [p.name for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]
        assert positional in (["V", "F"], ["path"], ["path", "V", "F"], ["spec", "n"], ["scene"]), name


def test_the_guide_names_every_function():
    text = GUIDE.read_text(encoding="utf-8")
    for name in functions():
        assert re.search(rf"\b{name}\b", text), name


def test_the_example_of_the_package_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "bindings" / "python" / "README.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(block, "README.md", "exec"), {})
    assert "is within" in printed.getvalue()
    assert (tmp_path / "H.png").read_bytes()[1:4] == b"PNG"


def test_flags_are_those_of_the_library():
    assert dict(_helfrich.FLAGS) == {name: int(flag) for name, flag in helfrich.Flag.__members__.items()}


NUMBER = re.compile(r"[+-]?\d+\.?(\d*)(e[+-]?\d+)?")


def compare(printed, shown):
    """The words are the same, and numbers to two units of their last digit, or 2 %: other versions of
    SciPy minimise in other steps."""
    assert NUMBER.sub("#", printed) == NUMBER.sub("#", shown), (printed, shown)
    for found, expected in zip(NUMBER.finditer(printed), NUMBER.finditer(shown)):
        value, wanted = float(found[0]), float(expected[0])
        if "." in expected[0]:
            unit = float(f"1{expected[2] or ''}") * 10.0 ** -len(expected[1])
            assert abs(value - wanted) <= 2 * unit + 0.02 * abs(wanted), printed
        else:
            assert value == wanted, printed


@pytest.mark.skipif("HELFRICH_NO_GUIDE" in os.environ, reason="the guide: HELFRICH_NO_GUIDE is set")
def test_the_guide(tmp_path, monkeypatch):
    """Every block of Python runs, in order, and prints what the next block shows."""
    pytest.importorskip("scipy")
    matplotlib = pytest.importorskip("matplotlib")
    pytest.importorskip("pyvista")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    text = GUIDE.read_text(encoding="utf-8")
    blocks = re.findall(r"^```(\w+)\n(.*?)^```", text, re.M | re.S)
    names = {"__name__": "guide"}
    count = 0
    for place, (language, block) in enumerate(blocks):
        if language != "python":
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block, f"PYTHON.md, block {place}", "exec"), names)
        count += 1
        if place + 1 < len(blocks) and blocks[place + 1][0] == "text":
            compare(printed.getvalue(), blocks[place + 1][1])
    assert count >= 10
    assert isinstance(names["np"], type(np))
