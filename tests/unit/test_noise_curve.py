"""The curve H: every control point is reached, straight in between, gradients in both arguments."""

from types import ModuleType

import numpy as np
import pytest

from voldetail.backend import mitsuba

mi: ModuleType = mitsuba()  # before Dr.Jit is imported, which would pick an LLVM of its own

import drjit as dr  # noqa: E402

from voldetail.noise.curve import evaluate_curve  # noqa: E402

CURVE = np.array([0.1, 0.9, 0.3, 0.0, 1.0, 0.5, 0.45, 0.7, 0.2, 0.6, 0.8])


@pytest.mark.parametrize("count", [2, 5, 11])
def test_control_points_are_reached(count: int) -> None:
    t = np.linspace(-1, 1, count)
    values = evaluate_curve(mi.Float(CURVE[:count]), mi.Float(t), count).numpy()
    assert values == pytest.approx(CURVE[:count], abs=2e-6)


def test_straight_between_and_flat_outside() -> None:
    t = np.concatenate([np.random.default_rng(0).uniform(-1, 1, 10_000), [-1.5, -1.0, 1.0, 1.0000001, 1.5]])
    values = evaluate_curve(mi.Float(CURVE), mi.Float(t), 11).numpy()
    assert values == pytest.approx(np.interp(t, np.linspace(-1, 1, 11), CURVE), abs=5e-6)


def test_gradient_in_t_is_the_slope_of_the_piece() -> None:
    t = mi.Float(np.linspace(-0.97, 0.97, 41))
    dr.enable_grad(t)
    dr.backward(dr.sum(evaluate_curve(mi.Float(CURVE), t, 11)))
    pieces = ((t.numpy() + 1) * 5).astype(int)
    assert dr.grad(t).numpy() == pytest.approx(np.diff(CURVE)[pieces] * 5, abs=1e-4)


def test_gradient_in_the_points_is_the_weight_of_each() -> None:
    t = np.random.default_rng(1).uniform(-1, 1, 200)
    points = mi.Float(CURVE)
    dr.enable_grad(points)
    dr.backward(dr.sum(evaluate_curve(points, mi.Float(t), 11)))
    hats = [np.interp(t, np.linspace(-1, 1, 11), np.eye(11)[i]).sum() for i in range(11)]
    assert dr.grad(points).numpy() == pytest.approx(np.array(hats), abs=1e-3)
    assert sum(hats) == pytest.approx(200)
