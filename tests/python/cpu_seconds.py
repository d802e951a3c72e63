"""With pytest's --durations, also the CPU seconds of each file, which other programs change less than the time."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator

import pytest

NAME = "cpu_seconds"  # among a report's properties, which workers hand on
SHOWN = 25  # files
BEGAN = pytest.StashKey[float]()


def spent() -> float:
    """Seconds of this process and of its children that have ended."""
    return sum(os.times()[:4])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Take the time of a test, with the fixtures that are made and ended for it."""
    item.stash[BEGAN] = spent()
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo) -> Iterator[None]:
    """Leave it in the last report of the test."""
    report = yield
    if call.when == "teardown":
        report.user_properties.append((NAME, spent() - item.stash[BEGAN]))
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Show the files that took the most, and the sum of all."""
    if config.option.durations is None:
        return
    files: Counter[str] = Counter()
    for report in terminalreporter.getreports(""):
        files[report.nodeid.partition("::")[0]] += sum(value for name, value in report.user_properties if name == NAME)
    terminalreporter.section("CPU seconds by file")
    for file, seconds in files.most_common(SHOWN):
        terminalreporter.write_line(f"{seconds:8.1f}  {file}")
    terminalreporter.write_line(f"{files.total():8.1f}  all {len(files)} files")
