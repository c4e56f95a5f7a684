"""What the tests of the wheel share: the repository's own data, and the program that came with the wheel."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
DELAY = ROOT / "data/examples/delay"

JOINT = {
    "joint": {"name": "pendulum", "inertia": 0.011, "moment": 0.05, "coulomb": 0.02, "viscous": 0.03, "rest": 0.0},
    "sensor": {"resolution": 0.006, "period": 0.008},
    "motor": {"kp": 8.0, "kd": 0.15},
}


@pytest.fixture
def program():
    """Runs the wheel's program from the repository's root."""
    path = Path(sys.executable).with_name("aibo-fit")
    assert path.exists(), "the wheel brings its program"

    def run(*words, code=0):
        # Python's own list of the environment: readline, which pytest may load, puts COLUMNS behind its back.
        done = subprocess.run([path, *map(str, words)], cwd=ROOT, capture_output=True, text=True, env=dict(os.environ))
        assert done.returncode == code, done.stderr
        return done

    return run


@pytest.fixture(autouse=True)
def in_root(monkeypatch):
    """Paths in documents are as they were given."""
    monkeypatch.chdir(ROOT)


@pytest.fixture
def chirp():
    """A servo with a pendulum whose setpoints come late."""
    table = np.genfromtxt(DELAY / "chirp-0.csv", delimiter=",", names=True)
    return {"t": table["t"], "q": table["q"], "q_ref": table["q_ref"]}
