"""What is answered: the program's own document, text and page, with names for what is asked for most."""

from __future__ import annotations

import html as _html
import json as _json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Union

if TYPE_CHECKING:
    import pandas

    from ._core import Answer


class _Result:
    """An answer; ``str()`` of it is what the program prints."""

    _tables: Dict[str, str] = {}
    _table = ""

    def __init__(self, answer: Answer) -> None:
        self._answer = answer
        self._document: Optional[Dict[str, Any]] = None

    def to_json(self) -> str:
        """The document as ``--json`` writes it, byte for byte; keys are in docs/reference/json.md."""
        return self._answer.json

    def to_dict(self) -> Dict[str, Any]:
        """The document as a dictionary of its own. Numbers that are not finite are ``None``."""
        return _json.loads(self._answer.json)

    def to_html(self) -> str:
        """The report: one page that needs no network."""
        return self._answer.html

    def save_html(self, path: Union[str, "os.PathLike[str]"]) -> Path:
        """Writes the report to a file and answers with its path."""
        path = Path(path)
        path.write_text(self._answer.html, encoding="utf-8")
        return path

    def save_json(self, path: Union[str, "os.PathLike[str]"]) -> Path:
        """Writes the document to a file, as ``--json`` does, and answers with its path."""
        path = Path(path)
        path.write_bytes(self._answer.json.encode("utf-8"))
        return path

    def to_pandas(self, table: Optional[str] = None) -> "pandas.DataFrame":
        """One of the answer's tables as a data frame; needs pandas. ``tables`` says which there are."""
        import pandas

        name = self._table if table is None else table
        if name not in self._tables:
            raise KeyError(f"no table `{name}`: expected one of {', '.join(self._tables)}")
        return pandas.json_normalize(self._rows(name))

    @property
    def tables(self) -> List[str]:
        """Names of the tables that ``to_pandas`` knows."""
        return list(self._tables)

    def _get(self) -> Dict[str, Any]:
        if self._document is None:
            self._document = self.to_dict()
        return self._document

    def _joints(self) -> Dict[Optional[str], Dict[str, Any]]:
        """The documents of a robot's joints, or this one."""
        joints = self._get().get("joints")
        if isinstance(joints, dict) and all(isinstance(joint, dict) for joint in joints.values()):
            return dict(joints)
        return {None: self._get()}

    def _rows(self, name: str) -> List[Dict[str, Any]]:
        rows: List[Dict[str, Any]] = []
        for joint, document in self._joints().items():
            part: Any = document
            for key in name.split("."):
                part = part.get(key) if isinstance(part, dict) else None
            if isinstance(part, dict):
                own = [{"name": key, **(value if isinstance(value, dict) else {"value": value})} for key, value in part.items()]
            else:
                own = [value if isinstance(value, dict) else {"value": value} for value in part or []]
            rows.extend(own if joint is None else [{"joint": joint, **row} for row in own])
        return rows

    def _undetermined(self) -> List[str]:
        return [sentence for document in self._joints().values() for sentence in document.get("undetermined") or []]

    def _repr_html_(self) -> str:
        page = _html.escape(self._answer.html, quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 42em; border: 1px solid #ccc"></iframe>'

    def __str__(self) -> str:
        return self._answer.text


class Gap(_Result):
    """Where model and logs part, which unmodelled effect is behind it, and how far the gap closes."""

    _tables = {
        "ranking": "effects by how far each closes the gap",
        "effects": "causes of the answer, in the order of the waterfall",
        "gap.waterfall": "RMS [rad or N m] as given, recalibrated, with each cause",
        "gap.per_log": "RMS [rad or N m] of each log",
        "beliefs": "what is believed of each number, and what was found",
        "joint": "the joint's numbers",
        "health": "what each log is like",
        "detectable": "the smallest size of each effect that these logs would show",
    }
    _table = "ranking"

    @property
    def verdict(self) -> str:
        """``effect``, ``none``, ``calibration`` or ``unexplained``."""
        return self._answer.verdict or ""

    @property
    def sentence(self) -> str:
        """What a colleague would say."""
        return self._answer.sentence or ""

    @property
    def probability(self) -> float:
        """The measured rate at which answers like this were right, 0 to 1."""
        return float("nan") if self._answer.probability is None else self._answer.probability

    @property
    def effect(self) -> Optional[str]:
        """The id of the effect that closes most; of a calibration the number that is off most; ``None``: none."""
        return self._get().get("effect")

    @property
    def effects(self) -> List[Dict[str, Any]]:
        """All causes of the answer, in the order of the waterfall."""
        return list(self._get().get("effects") or [])

    @property
    def undetermined(self) -> List[str]:
        """What these logs cannot tell, in sentences."""
        return self._undetermined()

    def __repr__(self) -> str:
        return f"<aibo_fit.Gap {self.verdict} ({self._answer.percent}): {self.sentence}>"


class Drop(_Result):
    """The simple and the extensive pendulum, fitted to swings."""

    _tables = {"joint": "the joint's numbers", "models": "both models", "logs": "RMS [rad] of each log"}
    _table = "joint"

    @property
    def sentence(self) -> str:
        """What a colleague would say."""
        return self._answer.sentence or ""

    def __repr__(self) -> str:
        return f"<aibo_fit.Drop: {self.sentence}>"


class Check(_Result):
    """What logs are like, and what they can and cannot tell, before any diagnosis."""

    _tables = {
        "health": "what each log is like",
        "beliefs": "what is believed of each number, and what was found",
        "detectable": "the smallest size of each effect that these logs would show",
    }
    _table = "health"

    @property
    def undetermined(self) -> List[str]:
        """What these logs cannot tell, in sentences."""
        return self._undetermined()

    def __repr__(self) -> str:
        return f"<aibo_fit.Check of {len(self._rows('health'))} logs>"
