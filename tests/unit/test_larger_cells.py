"""Cells become larger until they are affordable, and no larger than the step before says."""

import math

import pytest

from voldetail.field.larger_cells import affordable_edge


@pytest.mark.parametrize("wanted", [0.001, 0.01, 0.3])
def test_the_edge_is_affordable_and_the_one_before_was_not(wanted: float) -> None:
    found = affordable_edge(wanted, lambda edge: (0.1 / edge) ** 3, least_step=1.1, trust=0.0)
    assert found == pytest.approx(wanted * 1.1 ** max(0, math.ceil(math.log(0.1 / wanted, 1.1) - 1e-9)))
    assert (0.1 / found) ** 3 <= 1 + 1e-9


def test_cubic_costs_take_one_step_where_they_are_trusted() -> None:
    asked = []

    def cost(edge: float) -> float:
        asked.append(edge)
        return (0.1 / edge) ** 3

    assert affordable_edge(0.01, cost, least_step=1.05, trust=1.0) == pytest.approx(0.1, rel=0.06)
    assert len(asked) <= 3


def test_an_unknown_cost_is_approached_by_quarters() -> None:
    assert affordable_edge(1.0, lambda e: math.inf if e < 3 else 0.5, least_step=1.05, trust=1.0) == pytest.approx(1.25**5)


def test_what_never_fits_is_said() -> None:
    assert affordable_edge(1.0, lambda edge: 2.0, least_step=1.02, trust=0.9) == math.inf
