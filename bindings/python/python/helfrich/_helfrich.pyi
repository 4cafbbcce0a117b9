"""The compiled module. Everything but `Membrane` is for the package only."""

from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np

METHODS: List[Dict[str, Any]]
FLAGS: List[Tuple[str, int]]
EFFECTS: List[str]
SCENES: List[str]
__version__: str

_Mesh = Tuple[np.ndarray, np.ndarray]
_Mended = Tuple[_Mesh, Tuple[np.ndarray, np.ndarray], List[Tuple[str, int]], Tuple[int, int, str]]
_Sparse = Tuple[np.ndarray, np.ndarray, np.ndarray]

class Membrane:
    def __new__(
        cls, F: Any, *effects: Any, vertices: Optional[int] = None, threads: Optional[int] = None
    ) -> Membrane: ...
    def __getnewargs_ex__(self) -> Tuple[Tuple[Any, ...], Dict[str, Any]]: ...
    def energy(self, V: Any) -> float: ...
    def force(self, V: Any, out: Optional[np.ndarray] = None) -> np.ndarray: ...
    def energy_and_force(
        self, V: Any, out: Optional[np.ndarray] = None
    ) -> Tuple[float, np.ndarray]: ...
    def restore(self, V: Any) -> np.ndarray: ...
    def flags(self, V: Any) -> np.ndarray: ...
    @property
    def costs(self) -> List[Tuple[str, int, float]]: ...

def address(positions: Any) -> int: ...
def read(path: str) -> _Mesh: ...
def write(path: str, positions: Any, faces: Any, fields: Dict[str, np.ndarray]) -> None: ...
def shape(spec: str, vertices: int, family: str, seed: int) -> Tuple[_Mesh, Dict[str, Any]]: ...
def inspect(positions: Any, faces: Any) -> Dict[str, Any]: ...
def components(positions: Any, faces: Any) -> np.ndarray: ...
def weld(positions: Any, faces: Any, distance: float) -> Tuple[_Mesh, np.ndarray]: ...
def repair(
    positions: Any,
    faces: Any,
    *,
    weld: Optional[float],
    sheets: str,
    fill: int,
    slivers: float,
    outward: bool,
    drop_unused: bool,
) -> _Mended: ...
def repair_file(
    path: str,
    *,
    weld: Optional[float],
    sheets: str,
    fill: int,
    slivers: float,
    outward: bool,
    drop_unused: bool,
) -> _Mended: ...
def divided(positions: Any, corners: np.ndarray, sizes: np.ndarray) -> np.ndarray: ...
def subdivide(positions: Any, faces: Any, levels: int, limit: bool) -> _Mesh: ...
def curvature(
    positions: Any,
    faces: Any,
    *,
    method: str,
    areas: Optional[str],
    bandwidth: Optional[str],
    modulus: Any,
    spontaneous_curvature: Any,
    scale: Optional[int],
    radius: Optional[float],
    sigma: float,
    errors: bool,
    force: bool,
    threads: Optional[int],
) -> Dict[str, Any]: ...
def stiffness(
    positions: Any, faces: Any, areas: str
) -> Tuple[_Sparse, Optional[np.ndarray], Optional[_Sparse]]: ...
def laplacian(positions: Any, faces: Any, method: str) -> Tuple[_Sparse, np.ndarray, None]: ...
def gradient(positions: Any, faces: Any) -> np.ndarray: ...
def picture(
    positions: Any,
    faces: Any,
    *,
    values: Optional[np.ndarray],
    error: Optional[np.ndarray],
    directions: Optional[Tuple[np.ndarray, np.ndarray]],
    limits: Optional[Tuple[float, float]],
    diverging: Optional[bool],
    label: str,
    title: str,
    edges: bool,
    view: List[float],
    up: List[float],
    unit: Optional[str],
    size: Tuple[int, int],
    path: Optional[str],
) -> np.ndarray: ...
def recommend(
    positions: Any,
    faces: Any,
    *,
    error: float,
    quantity: str,
    norm: str,
    methods: Optional[List[str]],
    scalars: List[str],
    threads: Optional[int],
) -> str: ...
def remesh(
    positions: Any,
    faces: Any,
    *,
    vertices: Optional[int],
    edge: Any,
    curvature: Optional[float],
    error: Optional[float],
    creases: float,
    smooth: bool,
    fields: List[Tuple[str, List[float]]],
) -> Tuple[_Mesh, Tuple[np.ndarray, np.ndarray], np.ndarray, Dict[str, np.ndarray]]: ...
def smooth(
    positions: Any,
    faces: Any,
    *,
    scale: Optional[int],
    flow: Optional[float],
    threads: Optional[int],
) -> Tuple[Dict[str, Any], Optional[str]]: ...
class SmoothSurface:
    def __init__(self, positions: Any, faces: Any, method: str) -> None: ...
    def at(self, faces: List[int], weights: Any) -> Dict[str, np.ndarray]: ...
    def project(self, points: Any) -> Tuple[np.ndarray, np.ndarray]: ...
    def interpolate(self, field: List[float], faces: List[int], weights: Any) -> Tuple[np.ndarray, np.ndarray]: ...

def run(
    scene: str,
    text: Optional[str],
    settings: List[str],
    folder: str,
    resume: bool,
    callback: Optional[Callable[..., Any]],
    threads: Optional[int],
) -> Tuple[str, Dict[str, np.ndarray], Dict[str, _Mesh]]: ...
