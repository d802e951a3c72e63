"""Tasks on a cluster of Dask: the same results, under names for people, whoever is killed."""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path

import pytest

import task_examples
from quadgraph.base.errors import InputError, ToolError
from quadgraph.work import dask_workers
from quadgraph.work.dask_workers import DaskWorkers
from quadgraph.work.schedulers import Scheduler
from quadgraph.work.task import Task, key_of
from quadgraph.work.task_run import run_tasks

distributed = pytest.importorskip("distributed", reason="no dask.distributed: pip install 'quadgraph[cluster]'")
HERE = str(Path(task_examples.__file__).parent)


@pytest.fixture(scope="module")
def cluster():
    """Two workers of one thread each, which see the examples."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", HERE)
        patch.setattr(dask_workers, "_DASHBOARD", "127.0.0.1:0")
        with dask_workers.on_this_machine(2, 2 * 10**9, 1, lambda text: None) as workers:
            yield workers


@pytest.fixture
def address(cluster):
    return cluster._client.scheduler.address


def orders_of(tasks, ledger):
    return {key_of(task.content()): task.order(ledger) for task in tasks}


def test_results_are_those_of_own_processes(cluster, address, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", HERE)
    found = {}
    for name, scheduler in (("own", Scheduler("processes", 1)), ("dask", Scheduler("cluster", address=address))):
        (tmp_path / name).mkdir()
        found[name] = run_tasks(task_examples.notes(tmp_path / name, 3), scheduler, tmp_path / name / "ledger")
    assert found["own"] == found["dask"]
    assert {(tmp_path / "dask" / f"{number}.txt").read_text() for number in range(3)} == {"0", "1", "2"}


def test_the_dashboard_shows_names_for_people(cluster, tmp_path):
    list(cluster.outcomes(orders_of(task_examples.notes(tmp_path, 1), tmp_path / "ledger")))
    known = cluster._client.run_on_scheduler(lambda dask_scheduler: list(dask_scheduler.task_prefixes))
    assert "note\N{NON-BREAKING HYPHEN}of" in known


def test_tasks_wait_at_the_scheduler_for_whoever_is_free(cluster, tmp_path):
    """A worker that has been handed all that is left leaves the others without work."""
    outcomes = cluster.outcomes(orders_of(task_examples.notes(tmp_path, 9, 0.2), tmp_path / "ledger"))
    for _ in range(4):
        next(outcomes)
        assert max(len(tasks) for tasks in cluster._client.processing().values()) == 1
    assert len(list(outcomes)) == 5


def test_a_worker_that_is_killed_loses_nothing(cluster, tmp_path):
    tasks = task_examples.notes(tmp_path, 4, 0.3)
    orders = orders_of(tasks, tmp_path / "ledger")
    outcomes = cluster.outcomes(orders)
    found = dict([next(outcomes)])
    for process in cluster._client.run(os.getpid).values():
        os.kill(process, signal.SIGKILL)
    found |= dict(outcomes)
    assert [found[key] for key in orders] == [{"value": {"third": number / 3}} for number in range(4)]
    assert {path.read_text() for path in tmp_path.glob("*.txt")} == {"0", "1", "2", "3"}


def test_a_task_that_fails_says_why(cluster, tmp_path):
    orders = orders_of([Task("bake rag", "task_examples:torn", {"name": "rag.obj"})], tmp_path / "ledger")
    assert [outcome for _, outcome in cluster.outcomes(orders)] == [{"error": "rag.obj: is torn"}]


def test_a_scheduler_is_found_by_its_file(address, tmp_path):
    file = tmp_path / "scheduler.json"
    file.write_text(json.dumps({"type": "Scheduler", "address": address}))
    said = []
    with dask_workers.of_scheduler(file, said.append) as workers:
        assert isinstance(workers, DaskWorkers)
    assert said[0].startswith(f"{address}: 2 workers; dashboard: http://")


def test_wrong_files_are_named(tmp_path):
    with (
        pytest.raises(InputError, match="no such file; `dask scheduler --scheduler-file"),
        dask_workers.of_scheduler(tmp_path / "none.json", print),
    ):
        pass
    (tmp_path / "wrong.json").write_text("[]")
    with (
        pytest.raises(InputError, match=r"wrong\.json: not a scheduler file of Dask"),
        dask_workers.of_scheduler(tmp_path / "wrong.json", print),
    ):
        pass


def test_a_scheduler_that_is_not_there_is_named(monkeypatch):
    monkeypatch.setattr(dask_workers, "_REACHED", 0.2)
    with (
        pytest.raises(InputError, match=r"tcp://127\.0\.0\.1:9: no Dask scheduler answers there"),
        dask_workers.of_scheduler("tcp://127.0.0.1:9", print),
    ):
        pass


def test_a_scheduler_without_workers_is_named(monkeypatch):
    monkeypatch.setattr(dask_workers, "_JOINED", 0.2)
    with distributed.LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as empty:
        where = empty.scheduler_address
        with (
            pytest.raises(InputError, match=f"{where}: it has no workers after 0.2 s; `dask worker {where}` starts"),
            dask_workers.of_scheduler(where, print),
        ):
            pass


def test_workers_of_another_version_are_named(address, monkeypatch):
    monkeypatch.setattr(dask_workers, "__version__", "9.9")
    with (
        pytest.raises(ToolError, match=r"worker tcp://.*: has quadgraph .*, here 9\.9; install the same versions"),
        dask_workers.of_scheduler(address, print),
    ):
        pass


def test_the_extra_is_named_where_dask_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(InputError, match=r"distributed cannot be imported .*pip install 'quadgraph\[cluster\]'"),
        dask_workers.of_scheduler("tcp://127.0.0.1:9", print),
    ):
        pass


def test_a_scheduler_that_ends_is_told_of(tmp_path, capfd):
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0") as ending:
        tasks = task_examples.notes(tmp_path, 2, 0.2)
        with dask_workers.of_scheduler(ending.scheduler_address, print) as workers:
            outcomes = workers.outcomes(orders_of(tasks, tmp_path / "ledger"))
            next(outcomes)
            ending.close()
            with pytest.raises(ToolError, match="the scheduler is gone"):
                list(outcomes)
    assert "Traceback" not in capfd.readouterr().err
