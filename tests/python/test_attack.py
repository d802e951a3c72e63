"""Hostile inputs by seed (tests/attack/): eight in every run, five hundred in long ones, and the judge itself."""

from __future__ import annotations

import itertools
import signal
from dataclasses import replace

import pytest

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

from attack import runner
from attack.bodies import Bodies
from attack.case import CLASSES, GIGABYTE, Case, Place, Verdict
from attack.families import FAMILIES

SEED = 26
COUNT, LONG = 8, 500  # of each family one, and five hundred
PART = 12  # cases of one test, so that workers share them


def hold(first: int, count: int) -> None:
    """Run so many cases; none may be bad."""
    verdicts = runner.run(SEED, range(first, first + count))
    bad = [verdict for verdict in verdicts if not verdict.good]
    assert not bad, "\n" + "\n".join(map(told, bad))


def told(verdict: Verdict) -> str:
    """What became of a case, and how to run it again."""
    again = f"tools/attack --seed {SEED} --first {verdict.number} --count 1 --verbose"
    return f"{verdict.family} {verdict.number}, {verdict.kind}: {verdict.name}: {verdict.message}\n    {again}"


def test_hostile_inputs_are_refused_or_right():
    hold(0, COUNT)


@pytest.mark.long
@pytest.mark.parametrize("first", range(COUNT, LONG, PART))
def test_many_hostile_inputs_are_refused_or_right(first):
    hold(first, PART)


def test_families_take_turns_and_seeds_differ():
    """Every recipe is among a seed's cases; the same number is the same case; another seed's are others."""
    cases = [runner.draw(SEED, number) for number in range(LONG)]
    assert {family for family, _ in cases[: len(FAMILIES)]} == set(FAMILIES)
    assert max(map(len, FAMILIES.values())) * len(FAMILIES) <= LONG
    names = [case.name for _, case in cases]
    assert [runner.draw(SEED, number)[1].name for number in (0, 17, 99)] == [names[number] for number in (0, 17, 99)]
    others = {runner.draw(SEED + 1, number)[1].name for number in range(LONG)}
    assert len(others & set(names)) < 0.3 * LONG
    assert list(itertools.islice(runner.numbers("load"), 2)) == [7, 15]


def fake(program: str, **more: object) -> Case:
    """A case that runs a line of Python."""
    return Case("fake", ("python", "-c", program), **more)  # type: ignore[arg-type]


HIT = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
SAY = "import sys; sys.exit('quadgraph: error: {}')"
DEAF = (
    "import signal, time\nsignal.signal(signal.SIGTERM, lambda *_: None)\n"
    "for _ in range(10**9):\n    time.process_time()"
)
FAKES = {
    "refused": fake(SAY.format("body.qgraph: no file"), names=("body.qgraph",)),
    "fine": fake("print(1)", judge=lambda place, outcome: "" if outcome.stdout == "1\n" else "no 1"),
    "not converged": fake("import sys; sys.exit(3)", judge=lambda place, outcome: "never asked"),
    "crash": fake(HIT),
    "traceback": fake("raise ValueError('x')"),
    "traceback, no word": fake("import sys; sys.exit(1)"),
    "traceback, long": fake(SAY.format("x" * 600)),
    "traceback, no name": fake(SAY.format("something is wrong"), names=("body.qgraph",)),
    "traceback, escapes": fake(r"print('\x1b[31mred')"),
    "memory": fake("import time; x = bytearray(b'x' * 3 * 10**8); time.sleep(60)", memory=GIGABYTE // 10),
    "slow": fake("while True: pass", seconds=0.5),
    "slow, deaf": fake(DEAF, signals=((0.3, signal.SIGTERM),), seconds=0.6),
    "silent": fake("print(2)", judge=lambda place, outcome: "two"),
    "silent, accepted": fake("print(2)", expect="refused"),
    "left": fake("open('more', 'w').write('x')"),
    "left, gone": fake("import os; os.remove('kept')"),
    "left, temporary": fake("import os; open(os.environ['TMPDIR'] + '/t', 'w').write('x')"),
    "left, half": fake("open('out', 'w'); import sys; sys.exit('quadgraph: error: out')", outputs=("out",)),
    "left, running": fake("import subprocess; subprocess.Popen(['sleep', '60'], stdout=-3, stderr=-3)"),
    "denied": fake(SAY.format("no"), expect="fine"),
}


@pytest.mark.parametrize("name", FAKES)
def test_the_judge_knows_what_it_sees(tmp_path, name):
    """A program made to end so is classed so."""

    def prepare(place: Place) -> None:
        (place.folder / "kept").write_text("precious")

    case = replace(FAKES[name], prepare=prepare)
    kind, message, _ = runner.run_case(case, tmp_path / "case", Bodies(tmp_path))
    assert kind == {"not converged": "fine"}.get(name, name.partition(",")[0]), message


def test_every_class_is_seen():
    assert {name.partition(",")[0] for name in FAKES} - {"not converged"} == set(CLASSES)


def test_a_bad_case_is_told_with_its_command():
    text = told(Verdict(7, "load", "9 lights", "crash", "exit code -11", 1.0, 1))
    assert "tools/attack --seed 26 --first 7 --count 1 --verbose" in text
    assert "load 7, crash: 9 lights: exit code -11" in text
