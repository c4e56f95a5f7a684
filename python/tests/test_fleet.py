"""Many studies: by the package's program, and on a local Ray cluster."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import DELAY

from aibo_fit import fleet

PATTERN = "logs/**/study.toml"


@pytest.fixture
def logs(tmp_path, monkeypatch):
    """Three studies of two robots, and a bad one."""
    for place in ("dog-1/2026-03-01", "dog-1/2026-03-02", "dog-2/2026-03-01"):
        folder = tmp_path / "logs" / place
        folder.mkdir(parents=True)
        for name in ("study.toml", "chirp-0.csv"):
            shutil.copy(DELAY / name, folder)
    bad = tmp_path / "logs/dog-2/2026-03-02"
    bad.mkdir()
    (bad / "study.toml").write_text("schema = 1\n[joint\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*words, code):
    done = subprocess.run([sys.executable, "-m", "aibo_fit.fleet", *words], capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done


def test_without_ray_it_is_the_program(logs):
    run(PATTERN, "--out", "out", "--json", "fleet.json", "--quiet", code=1)
    found = json.loads((logs / "fleet.json").read_text())
    assert [row["study"] for row in found["failed"]] == ["logs/dog-2/2026-03-02/study.toml"]
    assert {(joint["robot"], joint["since"]) for joint in found["joints"]} == {("dog-1", "2026-03-01"), ("dog-2", "2026-03-01")}
    assert "kept from before: 4" in run(PATTERN, "--out", "out", code=1).stdout
    assert "no such study" in run("absent/*.toml", code=2).stderr


def test_the_table_is_a_data_frame(logs):
    pandas = pytest.importorskip("pandas", reason="pandas is optional")
    pytest.importorskip("pyarrow", reason="pandas reads Parquet with pyarrow")
    run(PATTERN, "--out", "out", "--quiet", code=1)
    table = pandas.read_parquet("out/fleet.parquet")
    assert len(table) == 4 and table.error.notna().sum() == 1
    late = table[table.cause == "delay"]
    assert len(late) == 3 and set(late["parameter"]) == {"T"}
    assert ((late.size_low < late["size"]) & (late["size"] < late.size_high)).all()
    assert str(late.day.iloc[0]) == "2026-03-01" and set(late.day_from) == {"path"}


@pytest.fixture(scope="module")
def cluster():
    ray = pytest.importorskip("ray", reason="Ray cannot be installed here")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    yield ray
    ray.shutdown()


def test_a_local_cluster_answers_what_the_program_answers(logs, cluster):
    run(PATTERN, "--out", "program", "--json", "program.json", "--quiet", code=1)
    text, is_whole = fleet.on_ray([PATTERN], out="ray", json="ray.json")
    assert not is_whole and "3 of 4 studies are answered" in text
    for name in ("fleet.parquet", "report.html"):
        assert (logs / "ray" / name).read_bytes() == (logs / "program" / name).read_bytes(), name
    assert (logs / "ray.json").read_bytes() == (logs / "program.json").read_bytes()
    answers = sorted(path.name for path in (logs / "ray/studies").iterdir())
    assert answers == sorted(path.name for path in (logs / "program/studies").iterdir())
    for name in answers:
        assert (logs / "ray/studies" / name).read_bytes() == (logs / "program/studies" / name).read_bytes(), name
    # Each goes on where the other was.
    assert "kept from before: 4" in run(PATTERN, "--out", "ray", code=1).stdout
    heard = []
    fleet.on_ray([PATTERN], out="program", progress=lambda *step: heard.append(step))
    assert heard == []


def test_a_file_that_cannot_be_read_is_tried_again(logs):
    study = logs / "logs/dog-1/2026-03-01"
    asked = str(study / "study.toml"), str(logs), [], [], False
    (study / "chirp-0.csv").unlink()
    assert fleet._answered(*asked)[3]
    (study / "chirp-0.csv").write_text("t,q\n0.0,nothing\n")
    assert not fleet._answered(*asked)[3]


def workers_at_work():
    """Processes of tasks, by Ray's own title of a process."""
    found = []
    for process in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{process}/cmdline", "rb") as words:
                if words.read().startswith(b"ray::_answered"):
                    found.append(int(process))
        except OSError:
            pass
    return found


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are looked for in /proc")
def test_a_killed_worker_loses_nothing(logs, cluster):
    killed, is_done = [], threading.Event()

    def kill():
        while not is_done.is_set() and not killed:
            for worker in workers_at_work()[:1]:
                os.kill(worker, signal.SIGKILL)
                killed.append(worker)
            time.sleep(0.01)

    hunter = threading.Thread(target=kill)
    hunter.start()
    fleet.on_ray([PATTERN], out="out", json="fleet.json", pages=True)
    is_done.set()
    hunter.join()
    assert killed, "no worker was seen at work"
    found = json.loads((logs / "fleet.json").read_text())
    assert [row["study"] for row in found["failed"]] == ["logs/dog-2/2026-03-02/study.toml"]
    assert sum(row["error"] is None for row in found["rows"]) == 3
    assert len(list((logs / "out/studies").glob("*/report.html"))) == 3


def test_names_may_be_one_word_a_path_or_read_once(monkeypatch):
    asked = []

    class Studies:
        def __init__(self, *words):
            asked.append(words)

        path = staticmethod(str)
        pending = staticmethod(lambda: [0])
        finish = staticmethod(lambda json: ("", True))
        store_error = staticmethod(lambda *words: None)

    def task(study, folder, *words):
        asked.append(words)
        return None, None, "none", False

    ray = SimpleNamespace(
        is_initialized=lambda: True,
        remote=lambda **options: lambda run: SimpleNamespace(remote=task),
        wait=lambda waiting, num_returns: (waiting[:1], waiting[1:]),
        get=lambda answer: answer,
        exceptions=SimpleNamespace(RayError=RuntimeError),
    )
    monkeypatch.setitem(sys.modules, "ray", ray)
    monkeypatch.setattr(fleet._core, "Fleet", Studies)
    fleet.on_ray(Path("a.toml"), without="delay", only=iter(["stribeck", "delay"]))
    fleet.on_ray("b.toml")
    words = (["delay"], ["stribeck", "delay"], False)
    assert asked[:2] == [(["a.toml"], "fits/fleet", *words), words]
    assert asked[2][0] == ["b.toml"]
