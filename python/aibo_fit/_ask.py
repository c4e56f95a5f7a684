"""Questions about logs: ``gap``, ``drop``, ``check``."""

from __future__ import annotations

import json as _json
import os
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Tuple, Union

import numpy as np

from . import _core
from ._results import Check, Drop, Gap

PathLike = Union[str, "os.PathLike[str]"]
Study = Union[PathLike, Mapping[str, Any], None]
Logs = Mapping[str, Mapping[str, Any]]
Progress = Callable[[str, int, int], Any]
Fixed = Union[Mapping[str, Optional[float]], Iterable[str]]

_NOTHING: Mapping[str, Any] = {}

_Arrays = Tuple[str, List[np.ndarray], List[Tuple[str, int, np.ndarray]]]


def gap(
    study: Study = None,
    logs: Optional[Logs] = None,
    *,
    robot: Optional[PathLike] = None,
    without: Iterable[str] = (),
    only: Iterable[str] = (),
    twins: int = 0,
    seed: int = 0,
    fix: Fixed = (),
    free: Iterable[str] = (),
    bound: Mapping[str, Tuple[float, float]] = _NOTHING,
    start: Mapping[str, float] = _NOTHING,
    budget: Optional[float] = None,
    progress: Optional[Progress] = None,
) -> Gap:
    """Diagnoses the gap between what is believed of a joint or robot and its logs, as ``aibo-fit gap`` does.

    ``study`` is the path of a study (TOML), or the same as a dictionary: ``{"joint": {"name": "elbow", "inertia": ...
    [kg m^2], "moment": ... [kg m], "coulomb": ... [N m], "viscous": ... [N m s/rad]}, "motor": {"kp": ... [N m/rad],
    "kd": ... [N m s/rad]}}``; all keys with units are in docs/reference/study.md. With ``robot`` (URDF, MJCF, TOML) it may be left
    out, or be the path of a log.

    ``logs`` are arrays by the name of the log: ``{"motion": {"t": ..., "q": ..., "q_ref": ...}}`` with ``t`` [s], ``q``
    [rad], ``q_ref`` [rad], ``tau`` [N m], ``drive`` (bool). An array with stamps of its own is a pair ``(t, values)``. Of
    a robot, columns are ``"elbow.q"`` and so on or ``{"elbow": {"q": ...}}``; or the keys of ``logs`` are the joints
    themselves, each with its ``t``. Logs that the study's ``log`` list does not mention need no entry there: a log with
    ``q_ref`` is taken as driven by position, one with ``tau`` alone by torque, else as a free swing, all of them to be
    fitted. Files that the study names are read as ever.

    ``without`` and ``only`` name effects, ``twins`` and ``seed`` are those of the program. ``fix`` holds numbers at values,
    ``{"moment": 0.05}``, or names those that are held as stated; ``free`` names what is searched without a belief; ``bound``
    has two values by name, ``start`` where a search begins; names are those of ``gap --help``, units SI. ``budget`` is the
    time for an answer [s]. ``progress(stage, done, of)`` is called as the work goes on; what it raises ends it, and so does
    Ctrl-C.

    Raises ``aibo_fit.Error`` with the program's words; ``aibo_fit.NeverMoved`` where nothing moves.
    """
    return Gap(
        _core.gap(
            _asked(study, logs, robot),
            {
                "without": _names(without),
                "only": _names(only),
                "twins": twins,
                "seed": seed,
                "demands": _demands(fix, free, bound, start),
                "budget_s": budget,
            },
            progress=progress,
        )
    )


def check(
    study: Study = None,
    logs: Optional[Logs] = None,
    *,
    robot: Optional[PathLike] = None,
    progress: Optional[Progress] = None,
) -> Check:
    """What logs are like and what they can tell, before any diagnosis. Arguments are those of ``gap``.

    Raises ``aibo_fit.Error`` with the program's words; ``aibo_fit.NeverMoved`` where nothing moves.
    """
    return Check(_core.check(_asked(study, logs, robot), progress=progress))


def drop(
    *paths: PathLike,
    study: Study = None,
    logs: Optional[Logs] = None,
    joint: Optional[str] = None,
    method: str = "lm",
    stribeck: bool = False,
    lump: bool = False,
    fix: Fixed = (),
    free: Iterable[str] = (),
    bound: Mapping[str, Tuple[float, float]] = _NOTHING,
    start: Mapping[str, float] = _NOTHING,
    progress: Optional[Progress] = None,
) -> Drop:
    """Fits the simple and the extensive pendulum to swings of a joint, as ``aibo-fit drop`` does.

    ``paths`` are logs with their sidecars; or ``study`` and ``logs`` are those of ``gap``. ``method`` is ``lm``, ``bfgs``
    or ``dfp``. ``fix``, ``free``, ``bound`` and ``start`` are those of ``gap``.

    Raises ``aibo_fit.Error`` with the program's words; ``aibo_fit.NeverMoved`` where nothing moves.
    """
    names = [os.fspath(path) for path in paths]
    if names and (study is not None or logs is not None):
        raise _core.Error("drop takes the paths of logs, or a study, not both")
    return Drop(
        _core.drop(
            names,
            (None, None, [], None) if names else _asked(study, logs, None),
            {
                "joint": joint,
                "method": method,
                "stribeck": stribeck,
                "lump": lump,
                "demands": _demands(fix, free, bound, start),
            },
            progress=progress,
        )
    )


def _demands(
    fix: Fixed,
    free: Iterable[str],
    bound: Mapping[str, Tuple[float, float]],
    start: Mapping[str, float],
) -> Dict[str, Any]:
    """What is demanded of numbers, as lists of names and values."""
    held = list(fix.items()) if isinstance(fix, Mapping) else [(name, None) for name in _names(fix)]
    return {"fix": held, "free": _names(free), "bound": list(bound.items()), "start": list(start.items())}


def _names(ids: Iterable[str]) -> List[str]:
    return [ids] if isinstance(ids, str) else [str(one) for one in ids]


def _asked(
    study: Study, logs: Optional[Logs], robot: Optional[PathLike]
) -> Tuple[Optional[str], Optional[str], List[_Arrays], Optional[str]]:
    """A path, or a study as JSON with the arrays that it names, and the robot."""
    model = None if robot is None else os.fspath(robot)
    if study is not None and not isinstance(study, Mapping):
        path = os.fspath(study)
        if not logs:
            return path, None, [], model
        raise _core.Error(f"{path}: a study in a file names its logs; with arrays give the study as a dictionary")
    if study is None and robot is None:
        raise _core.Error("nothing is believed: give a study (a path or a dictionary), or a robot")
    document: Dict[str, Any] = {"schema": 1}
    document.update(study or {})
    if robot is not None:
        of_robot = {"model": model, "scenario": "fixed"}
        of_robot.update(document.get("robot") or {})
        document["robot"] = of_robot
    given = {str(name): dict(log) for name, log in (logs or {}).items()}
    entries = [dict(entry) for entry in document.get("log") or []]
    if "robot" in document and given and not entries and all({"t", "q"} <= set(log) for log in given.values()):
        given = {"log": {joint: log for joint, log in given.items()}}
    arrays = [_arrays(name, log) for name, log in given.items()]
    named = {entry.get("file") for entry in entries}
    ours = {spec.get("name"): column for column, spec in (document.get("columns") or {}).items()}
    for name, _, columns in arrays:
        if name not in named:
            entries.append(_entry(name, {ours.get(column, column) for column, _, _ in columns}))
    document["log"] = entries
    return None, _json.dumps(document, default=_plain), arrays, model


def _entry(name: str, columns: Iterable[str]) -> Dict[str, str]:
    kinds = {column.rsplit(".", 1)[-1] for column in columns}
    drive = "position" if "q_ref" in kinds else "torque" if "tau" in kinds else "off"
    return {"file": name, "role": "fit", "drive": drive}


def _arrays(name: str, log: Mapping[str, Any]) -> _Arrays:
    """A log as clocks and columns; equal stamps are one clock."""
    clocks: List[np.ndarray] = []
    columns: List[Tuple[str, int, np.ndarray]] = []

    def clock(stamps: np.ndarray) -> int:
        for number, known in enumerate(clocks):
            if known is stamps or np.array_equal(known, stamps):
                return number
        clocks.append(stamps)
        return len(clocks) - 1

    def add(log: Mapping[str, Any], prefix: str, shared: Optional[np.ndarray]) -> None:
        own = _column(name, prefix + "t", log["t"]) if "t" in log else shared
        for column, values in log.items():
            if column == "t":
                continue
            if isinstance(values, Mapping):
                add(values, f"{prefix}{column}.", own)
                continue
            stamps = own
            if isinstance(values, tuple) and len(values) == 2:
                stamps, values = _column(name, f"{prefix}{column} stamps", values[0]), values[1]
            if stamps is None:
                raise _core.Error(f"{name}: `{prefix}{column}` has no stamps: `t` [s] is missing")
            columns.append((prefix + column, clock(stamps), _column(name, prefix + column, values)))

    add(log, "", None)
    return name, clocks, columns


def _column(log: str, column: str, values: Any) -> np.ndarray:
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise _core.Error(f"{log}: `{column}`: expected numbers: {error}") from None
    if array.ndim != 1:
        raise _core.Error(f"{log}: `{column}`: {array.ndim} dimensions, expected 1")
    return np.ascontiguousarray(array)


def _plain(value: Any) -> Any:
    """Numbers of NumPy and paths, as JSON has them."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    return os.fspath(value)
