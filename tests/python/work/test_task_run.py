"""Tasks in processes of this machine: what is finished is not done again, and what fails says why."""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import task_examples
from quadgraph.base.errors import ToolError
from quadgraph.work import finished_tasks, task_runner
from quadgraph.work.schedulers import Scheduler, scheduler
from quadgraph.work.task import Task
from quadgraph.work.task_run import run_tasks

TWO = Scheduler("processes", 2)
HERE = str(Path(task_examples.__file__).parent)
MUCH = 10**9  # bytes


@pytest.fixture(autouse=True)
def _examples_are_found(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", HERE)


def test_values_come_in_the_order_of_tasks_and_are_found_again(tmp_path):
    tasks = task_examples.notes(tmp_path, 3)
    values = run_tasks(tasks, TWO, tmp_path / "ledger")
    assert values == [{"third": number / 3} for number in range(3)]
    assert run_tasks(tasks, TWO, tmp_path / "ledger") == values
    assert sorted(number for number, _ in task_examples.starts(tmp_path)) == [0, 1, 2]


def test_what_was_read_or_written_otherwise_since_is_done_again(tmp_path):
    read = tmp_path / "read.txt"
    read.write_text("one")
    tasks = task_examples.notes(tmp_path, 2, reads=(read,))
    run_tasks(tasks, TWO, tmp_path / "ledger")
    (tmp_path / "1.txt").write_text("of somebody else")
    run_tasks(tasks, TWO, tmp_path / "ledger")
    assert sorted(number for number, _ in task_examples.starts(tmp_path)) == [0, 1, 1]
    assert (tmp_path / "1.txt").read_text() == "1"
    read.write_text("another")
    run_tasks(tasks, TWO, tmp_path / "ledger")
    assert sorted(number for number, _ in task_examples.starts(tmp_path)) == [0, 0, 1, 1, 1]


def test_a_damaged_note_is_none(tmp_path):
    (task,) = task_examples.notes(tmp_path, 1)
    run_tasks([task], TWO, tmp_path / "ledger")
    (note,) = (tmp_path / "ledger").iterdir()
    note.write_text(note.read_text()[:-9])
    assert finished_tasks.find(tmp_path / "ledger", task, task.content()) is None


def test_one_that_fails_leaves_the_others_finished(tmp_path, capsys):
    wrong = Task("bake rag", "task_examples:torn", {"name": "rag.obj"})
    tasks = [wrong, *task_examples.notes(tmp_path, 2)]
    with pytest.raises(ToolError, match=r"^1 of 3 failed: bake rag: rag\.obj: is torn$"):
        run_tasks(tasks, TWO, tmp_path / "ledger")
    assert sorted(path.name for path in tmp_path.glob("*.txt")) == ["0.txt", "1.txt"]
    assert "bake rag: failed" in capsys.readouterr().err


def test_a_process_that_is_killed_begins_again(tmp_path):
    task = Task("victim", "task_examples:killed_at_first", {"marker": str(tmp_path / "marker")})
    assert run_tasks([task], TWO, tmp_path / "ledger") == ["survived"]


def test_one_that_is_always_killed_is_given_up(tmp_path, monkeypatch):
    monkeypatch.setattr(task_runner, "ATTEMPTS", 1)
    task = Task("victim", "task_examples:killed_at_first", {"marker": str(tmp_path / "marker")})
    with pytest.raises(ToolError, match="victim: its process was killed 1 times"):
        run_tasks([task], TWO, tmp_path / "ledger")


def test_memory_is_bounded(tmp_path):
    order = Task("hoard", "task_examples:greedy", {"size": 300_000_000}).order(tmp_path)
    outcome = task_runner.run_order(order, 200_000_000)
    assert outcome["error"].startswith("hoard: took more than 0.2 GB, the limit of a worker")


def test_a_worker_that_sees_other_files_says_so(tmp_path):
    read = tmp_path / "read.txt"
    read.write_text("one")
    order = task_examples.notes(tmp_path, 1, reads=(read,))[0].order(tmp_path / "ledger")
    read.write_text("another")
    said = task_runner.run_order(order, MUCH)["error"]
    assert said.startswith(f"{read}: another content than where this was asked for; found on ")
    read.unlink()
    said = task_runner.run_order(order, MUCH)["error"]
    assert "read.txt: cannot be read" in said
    assert said.endswith("workers have to see the same files under the same names")
    moved = json.loads(order) | {"folder": str(tmp_path / "elsewhere")}
    assert "elsewhere: No such file" in task_runner.run_order(json.dumps(moved), MUCH)["error"]


@pytest.mark.parametrize(
    ("code", "words"), [("0" * 64, "is another build than the one that asks"), (None, "is another build")]
)
def test_another_build_is_refused(tmp_path, code, words):
    order = json.loads(task_examples.notes(tmp_path, 1)[0].order(tmp_path / "ledger"))
    order["content"]["code"]["quadgraph"] = code
    assert words in task_runner.run_order(json.dumps(order), MUCH)["error"]
    assert not task_examples.starts(tmp_path)


def test_a_package_that_is_not_there_is_named(tmp_path):
    order = json.loads(Task("far", "no_such_package:work", {}).order(tmp_path))
    assert task_runner.run_order(json.dumps(order), MUCH)["error"].startswith("no_such_package is not installed on ")


def program(folder: Path, count: int, seconds: float) -> subprocess.Popen[str]:
    command = [sys.executable, task_examples.__file__, str(folder), str(count), str(seconds)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)


def wait_for(condition, seconds=40):
    """Until something is so; a test that waits longer has failed."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def lives(process: int) -> bool:
    """Whether a process runs; one whose parent has not heard yet that it ended does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def finished(folder: Path) -> set[int]:
    return {int(json.loads(path.read_text())["task"].split()[1]) for path in (folder / "ledger").glob("[0-9a-f]*.json")}


def test_a_client_that_is_killed_repeats_nothing_that_was_finished(tmp_path):
    first = program(tmp_path, 4, 0.3)
    wait_for(lambda: finished(tmp_path))
    first.kill()
    first.communicate()
    done = finished(tmp_path)
    begun = task_examples.starts(tmp_path)
    wait_for(lambda: not any(lives(process) for _, process in begun))
    second = program(tmp_path, 4, 0.3)
    assert f"{len(done)} of 4 are finished already" in second.communicate()[1]
    assert second.returncode == 0
    assert all(sum(number == each for each, _ in task_examples.starts(tmp_path)) == 1 for number in done)
    assert finished(tmp_path) == {0, 1, 2, 3}


def test_an_interrupt_ends_all_processes_and_keeps_what_is_finished(tmp_path):
    run = program(tmp_path, 3, 60.0)
    wait_for(lambda: len(task_examples.starts(tmp_path)) == 2)
    run.send_signal(signal.SIGINT)
    said = run.communicate()[1]
    assert run.returncode == 130
    assert "interrupted; what is finished is kept" in said
    assert "Traceback" not in said
    assert not any(lives(process) for _, process in task_examples.starts(tmp_path))


def test_who_runs_tasks_is_read():
    assert scheduler("local:3") == Scheduler("local", 3)
    assert scheduler("processes:1") == Scheduler("processes", 1)
    assert scheduler("tcp://10.0.0.1:8786") == Scheduler("cluster", address="tcp://10.0.0.1:8786")
    assert scheduler("scheduler.json") == Scheduler("cluster", address=Path("scheduler.json"))


@pytest.mark.parametrize("text", ["local", "local:", "local:0", "local:x", "processes:1025", "tcp://host", "tcp://:1x"])
def test_what_is_none_is_refused(text):
    with pytest.raises(argparse.ArgumentTypeError, match="wanted"):
        scheduler(text)


def test_local_workers_without_dask_are_processes(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with Scheduler("local", 2).workers(print) as workers:
        assert type(workers).__name__ == "OwnProcesses"
    said = capsys.readouterr().out
    assert "2 workers on this machine without Dask (pip install 'quadgraph[cluster]'), each " in said
    assert " GB and " in said
