from typing import Any, Callable, List, Optional, Sequence, Tuple

import numpy as np

__version__: str

class Error(ValueError): ...
class NeverMoved(Error): ...
class Unreadable(Error): ...

class Answer:
    verdict: Optional[str]
    sentence: Optional[str]
    probability: Optional[float]
    json: str
    html: str
    text: str

_Arrays = Tuple[str, List[np.ndarray], List[Tuple[str, int, np.ndarray]]]
_Question = Tuple[Optional[str], Optional[str], List[_Arrays], Optional[str]]
_Progress = Optional[Callable[[str, int, int], Any]]
_Base = Optional[Tuple[List[float], List[float], List[float], List[float]]]

def main(program: Sequence[str], words: Sequence[str]) -> int: ...
def gap(
    question: _Question,
    without: Sequence[str] = (),
    only: Sequence[str] = (),
    twins: int = 0,
    seed: int = 0,
    progress: _Progress = None,
) -> Answer: ...
def check(question: _Question, progress: _Progress = None) -> Answer: ...
def drop(
    paths: Sequence[str],
    question: _Question,
    joint: Optional[str] = None,
    method: str = "lm",
    stribeck: bool = False,
    lump: bool = False,
    progress: _Progress = None,
) -> Answer: ...

class Fleet:
    def __init__(
        self, patterns: Sequence[str], folder: str, without: Sequence[str], only: Sequence[str], pages: bool
    ) -> None: ...
    def __len__(self) -> int: ...
    def pending(self) -> List[int]: ...
    def path(self, study: int) -> str: ...
    def pages_of(self, study: int) -> str: ...
    def store_answer(self, study: int, document: str) -> None: ...
    def store_error(self, study: int, why: str, lost: bool) -> None: ...
    def finish(self, json: Optional[str] = None) -> Tuple[str, bool]: ...

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
