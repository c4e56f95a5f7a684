"""Arrays go in as logs do from files."""

import json

import numpy as np
import pytest
from conftest import DELAY, JOINT, ROOT

import aibo_fit


def test_arrays_have_the_answer_of_their_file(chirp):
    found = aibo_fit.gap(JOINT, {"chirp-0.csv": chirp})
    of_file = aibo_fit.gap(DELAY / "study.toml")
    assert (found.verdict, found.effect, found.sentence) == ("effect", "delay", of_file.sentence)
    mine, theirs = found.to_dict(), of_file.to_dict()
    for said in ("command", "inputs"):
        mine.pop(said), theirs.pop(said)
    for row in mine["health"] + theirs["health"]:
        row["remarks"] = []
    assert json.dumps(mine, sort_keys=True) == json.dumps(theirs, sort_keys=True)


def test_the_answer_is_at_hand(chirp, tmp_path):
    found = aibo_fit.gap(JOINT, {"chirp": chirp})
    assert 0.0 < found.probability <= 1.0
    late = found.effects[0]["parameters"]["T"]
    assert late["unit"] == "s" and late["value"] == pytest.approx(0.016, abs=0.0005)
    assert found.to_dict()["gap"]["after"] < 0.1 * found.to_dict()["gap"]["before"]
    page = found.save_html(tmp_path / "report.html").read_text()
    assert page.startswith("<!DOCTYPE html>") or page.lstrip().lower().startswith("<!doctype html>")
    assert "srcdoc=" in found._repr_html_() and "iframe" in found._repr_html_()
    assert found.sentence in " ".join(str(found).split())
    assert repr(found).startswith("<aibo_fit.Gap effect")


def test_tables_are_data_frames(chirp):
    pandas = pytest.importorskip("pandas", reason="pandas is optional")
    found = aibo_fit.gap(JOINT, {"chirp": chirp})
    for name in found.tables:
        table = found.to_pandas(name)
        assert isinstance(table, pandas.DataFrame) and not table.empty, name
    ranking = found.to_pandas()
    assert "delay" in set(ranking["effect"]) and {"probability", "after"} <= set(ranking.columns)
    assert list(found.to_pandas("gap.per_log")["file"]) == ["chirp"]
    with pytest.raises(KeyError, match="expected one of ranking"):
        found.to_pandas("nonsense")


def test_units_signs_and_names_of_own_arrays(chirp):
    study = {
        **JOINT,
        "columns": {
            "q": {"name": "angle", "unit": "deg", "sign": -1},
            "q_ref": {"name": "target", "unit": "deg", "sign": -1},
        },
    }
    log = {"t": chirp["t"], "angle": -np.degrees(chirp["q"]), "target": -np.degrees(chirp["q_ref"])}
    assert aibo_fit.gap(study, {"chirp": log}).effect == "delay"


def test_setpoints_may_have_stamps_of_their_own(chirp):
    every_other = slice(None, None, 2)
    asked = (chirp["t"][every_other] - 0.001, chirp["q_ref"][every_other])
    looked = aibo_fit.check(JOINT, {"chirp": {"t": chirp["t"], "q": chirp["q"], "q_ref": asked}})
    health = looked.to_dict()["health"][0]
    assert health["setpoint_period_s"] == pytest.approx(0.016) and health["setpoint_before_reading_s"] == pytest.approx(0.001)


def test_swings_are_fitted():
    table = np.genfromtxt(ROOT / "data/q1.csv", delimiter=",", names=True)
    swing = {name: table[name] for name in table.dtype.names}
    study = {
        "joint": {"name": "hip", "inertia": 0.013, "moment": 0.08, "coulomb": 1e-3, "viscous": 0.017},
        "sensor": {"resolution": 0.006},
    }
    found = aibo_fit.drop(study=study, logs={"swing": {"t": swing["t"], "q": swing["q"], "drive": swing["drive"]}})
    assert "hip" in found.sentence and found.to_dict()["joint"]
    assert not aibo_fit.drop(study=study, logs={"swing": {"t": swing["t"], "q": swing["q"]}}).to_pandas().empty


def test_a_robot_of_arrays_is_that_of_its_files():
    study = ROOT / "data/examples/arm/study.toml"
    logs = {}
    for number in range(3):
        table = np.genfromtxt(ROOT / f"data/examples/arm/log{number}.csv", delimiter=",", names=True, deletechars="")
        logs[f"log{number}.csv"] = {name: table[name] for name in table.dtype.names}
    tables = {
        "joints": {"arm/shoulder": {"kp": 25.0, "kd": 0.5}, "arm/elbow": {"kp": 12.0, "kd": 0.2}},
        "sensor": {"resolution": 0.0005, "period": 0.01},
        "log": [
            {"file": f"log{number}.csv", "role": "validate" if number == 2 else "fit", "drive": "position"}
            for number in range(3)
        ],
    }
    found = aibo_fit.gap(tables, logs, robot=ROOT / "data/examples/arm/arm.urdf")
    assert found.sentence == aibo_fit.gap(study).sentence
    assert set(found.to_pandas("gap.per_log")["joint"]) == {"arm/shoulder", "arm/elbow"}
    assert set(found.to_pandas("joint")["joint"]) == {"arm/shoulder", "arm/elbow"}
    of_joints = [sentence for own in found.to_dict()["joints"].values() for sentence in own["undetermined"]]
    assert found.undetermined == of_joints
    # The keys may be the joints of one log.
    first = logs["log0.csv"]
    by_joint = {
        joint: {"t": first["t"], "q": first[f"{joint}.q"], "q_ref": first[f"{joint}.q_ref"]} for joint in tables["joints"]
    }
    beliefs = {key: tables[key] for key in ("joints", "sensor")}
    looked = aibo_fit.check(beliefs, by_joint, robot=ROOT / "data/examples/arm/arm.urdf")
    assert set(looked.to_dict()["joints"]) == {"arm/shoulder", "arm/elbow"}


WRONG = [
    ({"t": [0.0, 0.01], "q": [0.0]}, "`q`: 1 values, expected 2"),
    ({"q": [0.0, 0.1]}, "`t` [s] is missing"),
    ({"t": [0.0, 0.01], "q": [["a"], ["b"]]}, "expected numbers"),
    ({"t": np.zeros((2, 2)), "q": [0.0, 0.1]}, "2 dimensions, expected 1"),
    ({"t": np.arange(100) * 0.01, "q": np.full(100, np.nan)}, "expected a number"),
    ({"t": np.arange(100)[::-1] * 0.01, "q": np.sin(np.arange(100.0))}, "do not rise"),
    ({"t": np.arange(100) * 0.01, "position": np.sin(np.arange(100.0))}, "position"),
]


@pytest.mark.parametrize("log, said", WRONG)
def test_what_is_wrong_with_arrays_is_said(log, said):
    with pytest.raises(aibo_fit.Error) as raised:
        aibo_fit.gap(JOINT, {"motion": log})
    assert said in str(raised.value) and "motion" in str(raised.value)


def test_what_is_wrong_with_a_question_is_said(chirp):
    for ask, said in [
        (lambda: aibo_fit.gap(), "give a study"),
        (lambda: aibo_fit.gap(JOINT), "[[log]]"),
        (lambda: aibo_fit.gap("absent.toml"), "absent.toml"),
        (lambda: aibo_fit.gap("study.toml", {"a": chirp}), "a dictionary"),
        (lambda: aibo_fit.gap(JOINT, {"a": chirp}, without=["nonsense"]), "nonsense"),
        (lambda: aibo_fit.gap({**JOINT, "motr": {}}, {"a": chirp}), "motr"),
        (lambda: aibo_fit.drop(study=JOINT, logs={"a": chirp}, method="nonsense"), "nonsense"),
    ]:
        with pytest.raises(aibo_fit.Error) as raised:
            ask()
        assert said in str(raised.value)


def test_a_joint_that_never_moves_has_no_answer(chirp):
    still = {**chirp, "q": np.zeros_like(chirp["q"])}
    for ask in (aibo_fit.gap, aibo_fit.check):
        with pytest.raises(aibo_fit.NeverMoved):
            ask(JOINT, {"a": still})
