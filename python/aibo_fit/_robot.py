"""A robot's rigid-body dynamics."""

from __future__ import annotations

import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core

Vector = Union[Sequence[float], np.ndarray, Mapping[str, float]]


class Robot:
    """A robot as its URDF, MJCF or TOML describes it: mass matrix, gravity, accelerations, inverse dynamics.

    Joint vectors are in the order of ``joint_names`` [rad, rad/s, rad/s^2, N m; m and N of sliding joints], or dictionaries
    by joint name, where what is absent is 0. Where the base is free, vectors of freedoms begin with its six: velocity of
    the base frame's origin along world axes, then angular velocity along its own axes. Armature is in the mass matrix;
    friction, springs, limits and contacts are in none of this.
    """

    def __init__(self, core: _core.Robot) -> None:
        self._core = core

    @classmethod
    def from_file(
        cls,
        path: Union[str, "os.PathLike[str]"],
        *,
        base: Optional[str] = None,
        gravity: Optional[Sequence[float]] = None,
    ) -> "Robot":
        """Reads a description. ``base`` is ``fixed`` or ``free`` (as the file says), ``gravity`` [m/s^2] in its axes."""
        acceleration = None if gravity is None else [float(value) for value in gravity]
        if acceleration is not None and len(acceleration) != 3:
            raise _core.Error(f"`gravity`: {len(acceleration)} values, expected 3 [m/s^2]")
        return cls(_core.Robot.from_file(os.fspath(path), base, acceleration))

    @property
    def name(self) -> str:
        """As the description has it."""
        return self._core.name

    @property
    def joint_names(self) -> List[str]:
        """Joints that move freely, in the order of all vectors; one that follows another is none of them."""
        return self._core.joint_names

    @property
    def base(self) -> str:
        """``fixed`` or ``free``."""
        return self._core.base

    @property
    def freedoms(self) -> int:
        """Length of vectors of freedoms: the joints, and six where the base is free."""
        return self._core.freedoms

    @property
    def mass(self) -> float:
        """Of all links [kg]."""
        return self._core.mass

    @property
    def gravity_vector(self) -> Tuple[float, float, float]:
        """Acceleration of gravity in the description's axes [m/s^2]."""
        return tuple(self._core.gravity)

    @property
    def warnings(self) -> List[str]:
        """What looks like a mistake in the description."""
        return self._core.warnings

    def mass_matrix(self, q: Optional[Vector] = None, *, base: Optional[Mapping[str, Any]] = None) -> np.ndarray:
        """The mass matrix with armature, freedoms by freedoms [kg m^2 in joints that turn]."""
        return self._core.mass_matrix(self._vector("q", q), _base(base))

    def bias(
        self, q: Optional[Vector] = None, dq: Optional[Vector] = None, *, base: Optional[Mapping[str, Any]] = None
    ) -> np.ndarray:
        """Coriolis, centrifugal and gravity forces [N m]."""
        return self._core.bias(self._vector("q", q), self._vector("dq", dq), _base(base))

    def gravity(self, q: Optional[Vector] = None, *, base: Optional[Mapping[str, Any]] = None) -> np.ndarray:
        """Torques that hold the robot still against gravity [N m]."""
        still = None if base is None else {key: base[key] for key in ("position", "quaternion") if key in base}
        return self._core.bias(self._vector("q", q), None, _base(still))

    def inverse_dynamics(
        self,
        q: Optional[Vector] = None,
        dq: Optional[Vector] = None,
        ddq: Optional[Vector] = None,
        *,
        base: Optional[Mapping[str, Any]] = None,
    ) -> np.ndarray:
        """Forces on all freedoms that accelerations ``ddq`` ask for [N m]; ``ddq`` is as long as ``freedoms``."""
        size = self.freedoms
        ahead = np.zeros(size) if ddq is None else self._freedoms(ddq)
        return self._core.inverse(self._vector("q", q), self._vector("dq", dq), ahead, _base(base))

    def accelerations(
        self,
        q: Optional[Vector] = None,
        dq: Optional[Vector] = None,
        tau: Optional[Vector] = None,
        *,
        base: Optional[Mapping[str, Any]] = None,
    ) -> np.ndarray:
        """Accelerations of all freedoms [rad/s^2] under torques ``tau`` at the joints [N m]."""
        return self._core.forward(self._vector("q", q), self._vector("dq", dq), self._vector("tau", tau), _base(base))

    def _vector(self, name: str, values: Optional[Vector]) -> np.ndarray:
        if values is None:
            return np.zeros(len(self.joint_names))
        if isinstance(values, Mapping):
            unknown = [joint for joint in values if joint not in self.joint_names]
            if unknown:
                raise _core.Error(f"`{name}`: the robot has no joint `{unknown[0]}`; it has {', '.join(self.joint_names)}")
            values = [values.get(joint, 0.0) for joint in self.joint_names]
        return np.ascontiguousarray(values, dtype=np.float64).reshape(-1)

    def _freedoms(self, values: Vector) -> np.ndarray:
        if isinstance(values, Mapping):
            joints = self._vector("ddq", values)
            return np.concatenate([np.zeros(self.freedoms - len(joints)), joints])
        return np.ascontiguousarray(values, dtype=np.float64).reshape(-1)

    def __repr__(self) -> str:
        return f"<aibo_fit.Robot {self.name}: {len(self.joint_names)} joints, {self.base} base, {self.mass:.3g} kg>"


def _base(base: Optional[Mapping[str, Any]]) -> Optional[Tuple[List[float], List[float], List[float], List[float]]]:
    """A base's state: ``position`` [m], ``quaternion`` (w, x, y, z), ``velocity`` [m/s], ``rate`` [rad/s]."""
    if base is None:
        return None
    rest: Dict[str, List[float]] = {
        "position": [0.0] * 3,
        "quaternion": [1.0, 0.0, 0.0, 0.0],
        "velocity": [0.0] * 3,
        "rate": [0.0] * 3,
    }
    unknown = [key for key in base if key not in rest]
    if unknown:
        raise _core.Error(f"`base`: no `{unknown[0]}`; expected {', '.join(rest)}")
    for key, expected in list(rest.items()):
        if key in base:
            rest[key] = [float(value) for value in base[key]]
            if len(rest[key]) != len(expected):
                raise _core.Error(f"`base` {key}: {len(rest[key])} values, expected {len(expected)}")
    return rest["position"], rest["quaternion"], rest["velocity"], rest["rate"]
