"""Engines that two threads share, or that a fork inherits: answered, at once."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from baked import write_levels
from shapes import torus

core = pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

FORKED = """
import os, sys
from quadgraph import _core
from pathlib import Path
engine = _core.Engine(Path(sys.argv[1]), device="cpu")
engine.set_material("marble")
before = engine.solve()["energy"]["entered"]
child = os.fork()
if child == 0:
    try:
        engine.solve()
    except Exception as error:
        print(error, flush=True)
    again = _core.Engine(Path(sys.argv[1]), device="cpu")
    again.set_material("marble")
    print(again.solve()["energy"]["entered"] == before, flush=True)
    sys.exit(0)
assert os.waitpid(child, 0)[1] == 0
print(engine.solve()["energy"]["entered"] == before)
"""


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    return write_levels(tmp_path_factory.mktemp("shared") / "ring.qgraph", [torus(10, 4, 24, 12)])


def test_threads_that_share_an_engine_solve_or_are_told_to_take_turns(ring):
    engine = core.Engine(ring, device="cpu")
    engine.set_material("marble")
    alone = engine.solve()["energy"]["entered"]
    answers: list = []

    def work() -> None:
        for _ in range(4):
            try:
                answers.append(engine.solve()["energy"]["entered"])
            except Exception as error:
                answers.append(str(error))

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    assert len(answers) == 8
    said = [answer for answer in answers if isinstance(answer, str)]
    assert all("in use by another thread" in text for text in said)
    assert all(answer == alone for answer in answers if not isinstance(answer, str))
    assert engine.solve()["energy"]["entered"] == alone


def test_a_fork_is_told_at_once_and_makes_its_own(ring):
    command = [sys.executable, "-c", FORKED, ring]
    paths = os.pathsep.join([str(Path(core.__file__).parents[1]), *sys.path])
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, env=os.environ | {"PYTHONPATH": paths})
    said = done.stdout.splitlines()
    assert done.returncode == 0, done.stderr
    assert "made before this process was forked" in said[0]
    assert said[1:] == ["True", "True"]


def test_twenty_engines_of_one_process_answer_alike_and_leave_nothing(ring):
    before = core.live_objects()
    engines = [core.Engine(ring, device="cpu") for _ in range(20)]
    for engine in engines:
        engine.set_material("marble")
    answers = [engine.solve()["energy"]["entered"] for engine in engines]
    assert answers[1:] == answers[:-1]
    with_twenty = core.live_objects()
    assert with_twenty["device"] == before.get("device", 0) + 20
    del engine, engines
    gc.collect()
    assert core.live_objects() == before
