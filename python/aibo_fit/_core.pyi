from typing import Any, Callable, List, Optional, Sequence, Tuple

import numpy as np

__version__: str

class Error(ValueError): ...
class NeverMoved(Error): ...

class Answer:
    verdict: Optional[str]
    sentence: Optional[str]
    probability: Optional[float]
    json: str
    html: str
    text: str

_Arrays = Tuple[str, List[np.ndarray], List[Tuple[str, int, np.ndarray]]]
_Progress = Optional[Callable[[str, int, int], Any]]
_Base = Optional[Tuple[List[float], List[float], List[float], List[float]]]

def main(words: Sequence[str]) -> int: ...
def gap(
    path: Optional[str] = None,
    study: Optional[str] = None,
    logs: Sequence[_Arrays] = (),
    robot: Any = None,
    without: Sequence[str] = (),
    only: Sequence[str] = (),
    twins: int = 0,
    seed: int = 0,
    progress: _Progress = None,
) -> Answer: ...
def check(
    path: Optional[str] = None,
    study: Optional[str] = None,
    logs: Sequence[_Arrays] = (),
    robot: Any = None,
    progress: _Progress = None,
) -> Answer: ...
def drop(
    paths: Sequence[str] = (),
    path: Optional[str] = None,
    study: Optional[str] = None,
    logs: Sequence[_Arrays] = (),
    joint: Optional[str] = None,
    method: str = "lm",
    stribeck: bool = False,
    lump: bool = False,
    progress: _Progress = None,
) -> Answer: ...

class Robot:
    @staticmethod
    def from_file(path: str, base: Optional[str] = None, gravity: Optional[List[float]] = None) -> Robot: ...
    name: str
    joint_names: List[str]
    base: str
    freedoms: int
    mass: float
    gravity: List[float]
    warnings: List[str]
    def mass_matrix(self, q: np.ndarray, base: _Base = None) -> np.ndarray: ...
    def bias(self, q: np.ndarray, dq: Optional[np.ndarray] = None, base: _Base = None) -> np.ndarray: ...
    def inverse(self, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray, base: _Base = None) -> np.ndarray: ...
    def forward(self, q: np.ndarray, dq: np.ndarray, tau: np.ndarray, base: _Base = None) -> np.ndarray: ...
