"""While it runs: progress, Ctrl-C, other threads."""

import os
import signal
import threading
import time

import pytest
from conftest import JOINT

import aibo_fit


def test_progress_is_told(chirp):
    heard = []
    aibo_fit.gap(JOINT, {"chirp": chirp}, progress=lambda stage, done, of: heard.append((stage, done, of)))
    assert heard and all(isinstance(stage, str) and 0 <= done and 0 <= of for stage, done, of in heard)
    assert len({stage for stage, _, _ in heard}) > 2


def test_what_progress_raises_ends_it(chirp):
    class Enough(Exception):
        pass

    def stop(stage, done, of):
        raise Enough(stage)

    began = time.monotonic()
    with pytest.raises(Enough):
        aibo_fit.gap(JOINT, {"chirp": chirp}, twins=5000, progress=stop)
    assert time.monotonic() - began < 30.0


def test_ctrl_c_ends_it(chirp):
    threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        aibo_fit.gap(JOINT, {"chirp": chirp}, twins=5000)
    assert time.monotonic() - began < 30.0


def test_other_threads_go_on(chirp):
    ticks, is_done = [], threading.Event()

    def tick():
        while not is_done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.01)

    other = threading.Thread(target=tick)
    other.start()
    began = time.monotonic()
    aibo_fit.gap(JOINT, {"chirp": chirp})
    lasted = time.monotonic() - began
    is_done.set()
    other.join()
    assert len(ticks) > 10 * lasted, f"{len(ticks)} ticks in {lasted:.1f} s"
