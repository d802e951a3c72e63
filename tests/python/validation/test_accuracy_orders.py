"""How the error of each method falls with the element size, against closed forms and a manufactured solution."""

from __future__ import annotations

import pytest

from quadgraph_validation.accuracy import orders_study
from quadgraph_validation.truth import schemes
from quadgraph_validation.truth.schemes import PUBLISHED

pytest.importorskip("quadgraph._core", reason="the compiled engine is not built: run tools/setup")

LINEAR_ELEMENTS = 1.9  # the least fitted order


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=case.name, marks=pytest.mark.long if case.name == "sphere" else ())
        for case in orders_study.BODIES
    ],
)
def test_fem_is_of_second_order_in_both_models(case):
    record = orders_study.study(schemes.on_reference, case, 3, orders_study.FEM)
    print(record)
    assert min(record["orders"].values()) >= LINEAR_ELEMENTS
    assert max(errors[-1] for errors in record["errors"].values()) < 0.002


def test_fem_is_of_second_order_where_coefficients_vary():
    record = orders_study.manufactured_study(3)
    print(record)
    assert min(record["orders"].values()) >= LINEAR_ELEMENTS


@pytest.fixture(scope="module")
def sphere():
    return orders_study.study(
        schemes.on_reference, orders_study.BODIES[0], 2, (*orders_study.FEM, *orders_study.GRAPH_METHODS)
    )["errors"]


def test_fv_is_between_fem_and_the_published_differences(sphere):
    """Two-point flux is conservative, not consistent (docs/physics.md, "Discretisations"): a plateau below FDM's."""
    print(sphere)
    for fem, fv in zip(orders_study.FEM, orders_study.FV, strict=True):
        assert sphere[fem.name][-1] < sphere[fv.name][-1] < 0.05
    assert sphere[orders_study.FV[0].name][-1] < sphere[PUBLISHED.name][-1]


def test_the_published_differences_do_not_converge(sphere, record_property):
    """They are inconsistent (docs/physics.md, "Discretisations"): the error is recorded, bounded, and stays."""
    errors = sphere[PUBLISHED.name]
    record_property("quadgraph-fdm errors", errors)
    assert max(errors) < 0.5
    assert errors[-1] > 0.5 * errors[0]
