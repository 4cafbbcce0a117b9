"""Runs of scenes."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _checks, _helfrich
from ._arrays import both
from ._meshes import write

Callback = Callable[[float, str, Dict[str, np.ndarray]], Any]


@dataclass(frozen=True)
class Run:
    """The result of `run`."""

    end: str
    """"converged", "completed", "unresolved", "iteration-limit", "stagnated", "failed" or "interrupted"."""
    message: str
    """The same in words."""
    series: Dict[str, np.ndarray]
    """The columns of the series, float64, one number for each row."""
    surfaces: Dict[str, Tuple[np.ndarray, np.ndarray]]
    """V and F of each surface where the run ended."""
    warnings: List[str]
    """Remarks on the results."""
    summary: Dict[str, Any]
    """Everything that `summary.json` of the program has."""
    folder: Optional[Path]
    """The folder with the outputs; None if none was named."""


def run(
    scene: "str | os.PathLike[str] | Mapping[str, Any]",
    *,
    set: Optional[Mapping[str, Any]] = None,
    out: "str | os.PathLike[str] | None" = None,
    resume: bool = False,
    callback: Optional[Callback] = None,
    threads: Optional[int] = None,
) -> Run:
    """Runs a scene: membranes with elasticity and constraints, relaxed or carried by a Stokes flow.

    Parameters
    ----------
    scene : path, name or dict
        A TOML file, the name of a scene that comes with the package (`helfrich.SCENES`), or the same
        tables as a dict. In a dict, `mesh` may be a pair (V, F) or a mesh of pyvista or trimesh.
    set : dict, optional
        Values that replace those of the scene, by their path: {"surface.0.bending.modulus": 0.3}. None
        removes a key.
    out : path, optional
        Folder for the outputs, as those of the program: the series, surfaces, pictures, a checkpoint.
        Without it nothing is kept.
    resume : bool
        Continue the run in the folder from its last checkpoint.
    callback : function, optional
        Called after each step with the fraction that is done, a message, and a dict of the positions of
        each surface. The run ends if it returns False.
    threads : int, optional
        Number of threads, all by default. Results do not depend on it.

    Returns
    -------
    Run
        `end message series surfaces warnings summary folder`.

    Raises
    ------
    ValueError
        Everything that is wrong with the scene.
    OSError
        If outputs cannot be written.
    KeyboardInterrupt
        After Ctrl-C. The run has written a checkpoint to `out`, from which it can be resumed.

    Examples
    --------
    >>> import helfrich
    >>> vesicle = helfrich.run({
    ...     "units": "none",
    ...     "surface": [{
    ...         "name": "vesicle", "shape": "ellipsoid:0.8,0.8,1.4", "vertices": 162,
    ...         "bending": {"method": "gompper-kroll", "modulus": 1},
    ...         "area": {"constraint": "exact"}, "volume": {"constraint": "exact"},
    ...     }],
    ...     "driver": {"kind": "relax", "energy_error": 0.2},
    ... })
    >>> bool(vesicle.series["energy"][-1] < vesicle.series["energy"][0])
    True
    """
    callback, threads = _checks.called(callback, "callback"), _checks.threads(threads)
    out = None if out is None else _checks.path(out, "out")
    if not isinstance(set, (Mapping, type(None))):
        raise TypeError(f"set is {_checks.shown(set)}: a dict of values by their paths is needed")
    if _checks.flag(resume, "resume") and out is None:
        raise ValueError("resume is for a run in a folder: name it with out")
    with tempfile.TemporaryDirectory(prefix="helfrich-") as scratch:
        text = None
        path = "scene.toml"
        if isinstance(scene, Mapping):
            text = _Writer(scratch).document(scene)
        else:
            path = _checks.path(scene, "scene")
        settings = [
            f"{key}=" if value is None else f"{key}={_Writer(scratch).value(value, str(key))}"
            for key, value in (set or {}).items()
        ]
        if out is None:
            # Nobody would see them.
            settings += ["output.pictures=false", "output.surfaces=false", "output.plot=", "output.slice="]
            settings += ["output.volume="]
        folder = out if out is not None else os.path.join(scratch, "run")
        found = _helfrich.run(path, text, settings, folder, resume, callback, threads)
    summary, series, surfaces = json.loads(found[0]), found[1], found[2]
    return Run(
        end=summary["end"],
        message=summary["message"],
        series=series,
        surfaces=surfaces,
        warnings=summary["warnings"],
        summary=summary,
        folder=None if out is None else Path(folder),
    )


class _Writer:
    """Writes the tables of a scene as TOML, and its meshes as files."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._count = 0

    def document(self, tables: Mapping[str, Any]) -> str:
        lines = (f"{_quoted(str(key), 'a key')} = {self._of(key, value, str(key))}" for key, value in tables.items())
        return "\n".join(lines) + "\n"

    def _of(self, key: Any, value: Any, place: str) -> str:
        if key == "mesh" and not isinstance(value, (str, os.PathLike, Mapping)):
            return self.value(self._file(value), place)
        return self.value(value, place)

    def _file(self, mesh: Any) -> str:
        V, F = mesh if isinstance(mesh, tuple) and len(mesh) == 2 else both(mesh, None)
        self._count += 1
        path = os.path.join(self._folder, f"mesh-{self._count}.ply")
        write(path, V, F)
        return path

    def value(self, value: Any, place: str) -> str:
        """A value as TOML; `place` is its path in the scene, for messages."""
        if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
            raise ValueError(f"{place} has masked entries: numbers are needed for them")
        if isinstance(value, (np.ndarray, np.generic)):
            value = value.tolist()
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, int):
            return str(_checks.whole(value, place, -(2**63), 2**63 - 1))
        if isinstance(value, float):
            return repr(value)
        if isinstance(value, os.PathLike):
            value = _checks.path(value, place)
        if isinstance(value, str):
            return _quoted(value, place)
        if isinstance(value, Mapping):
            entries = (
                f"{_quoted(str(key), place)} = {self._of(key, entry, f'{place}.{key}')}"
                for key, entry in value.items()
            )
            return "{ " + ", ".join(entries) + " }"
        if isinstance(value, (list, tuple)):
            parts = (self.value(entry, f"{place}.{number}") for number, entry in enumerate(value))
            return "[" + ", ".join(parts) + "]"
        raise TypeError(
            f"{place} is {_checks.shown(value)}, which cannot be a value of a scene: a number, a text, True or "
            "False, a list or a dict is needed"
        )


def _quoted(text: str, place: str) -> str:
    """A text as TOML, which has the escapes of JSON, and one more."""
    return json.dumps(_checks.unicode(text, place), ensure_ascii=False).replace("\x7f", "\\u007f")
