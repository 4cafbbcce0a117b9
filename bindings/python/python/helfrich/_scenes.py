"""Runs of scenes."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _helfrich
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
    if resume and out is None:
        raise ValueError("resume is for a run in a folder: name it with out")
    with tempfile.TemporaryDirectory(prefix="helfrich-") as scratch:
        text = None
        path = "scene.toml"
        if isinstance(scene, Mapping):
            text = _Writer(scratch).document(scene)
        else:
            path = os.fspath(scene)
        settings = [
            f"{key}=" if value is None else f"{key}={_Writer(scratch).value(value)}"
            for key, value in (set or {}).items()
        ]
        if out is None:
            # Nobody would see them.
            settings += ["output.pictures=false", "output.surfaces=false", "output.plot=", "output.slice="]
            settings += ["output.volume="]
        folder = os.fspath(out) if out is not None else os.path.join(scratch, "run")
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
        lines = (f"{json.dumps(str(key))} = {self._of(key, value)}" for key, value in tables.items())
        return "\n".join(lines) + "\n"

    def _of(self, key: Any, value: Any) -> str:
        if key == "mesh" and not isinstance(value, (str, os.PathLike, Mapping)):
            return self.value(self._file(value))
        return self.value(value)

    def _file(self, mesh: Any) -> str:
        V, F = mesh if isinstance(mesh, tuple) else both(mesh, None)
        self._count += 1
        path = os.path.join(self._folder, f"mesh-{self._count}.ply")
        write(path, V, F)
        return path

    def value(self, value: Any) -> str:
        if isinstance(value, (np.ndarray, np.generic)):
            value = value.tolist()
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, int):
            return str(value)
        if isinstance(value, float):
            return repr(value)
        if isinstance(value, (str, os.PathLike)):
            return json.dumps(os.fspath(value)).replace("\x7f", "\\u007f")
        if isinstance(value, Mapping):
            entries = (f"{json.dumps(str(key))} = {self._of(key, entry)}" for key, entry in value.items())
            return "{ " + ", ".join(entries) + " }"
        if isinstance(value, (list, tuple)):
            return "[" + ", ".join(self.value(entry) for entry in value) + "]"
        raise TypeError(f"{value!r} cannot be a value of a scene: it is {type(value).__name__}")
