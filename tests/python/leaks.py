"""Fails tests that leave something on a device."""

from __future__ import annotations

import gc

import pytest


def left_behind(first: int) -> dict[str, int]:
    """Objects by kind, of the devices from number `first` on, after what nobody refers to has gone."""
    from quadgraph import _core

    left = _core.live_objects(first)
    if left:  # not always: collecting takes longer than most tests
        gc.collect()
        left = _core.live_objects(first)
    return left


@pytest.fixture(autouse=True)
def nothing_left_on_devices(request):
    """A test keeps no device that it has opened, nor anything of one; those of wider fixtures, made before, stay.

    A test that has failed is not judged: its traceback keeps what it was working with.
    """
    try:
        from quadgraph import _core
    except ImportError:  # not built
        yield
        return
    first, failed = _core.devices_opened(), request.session.testsfailed
    yield
    request.node.funcargs.clear()  # values of its fixtures, which are over by now but for this one
    if request.session.testsfailed == failed:
        assert not (left := left_behind(first)), f"left behind on devices: {left}"
