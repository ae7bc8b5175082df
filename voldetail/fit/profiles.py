"""Profiles H as three numbers: rising curves, and what folds them."""

from __future__ import annotations

import math

import numpy as np

from voldetail.detail.parameters import CURVE_POINTS
from voldetail.fit.ranges import SHAPE_RANGE
from voldetail.types import Vector

SHAPE_COUNT = 3

FOLDS = ("none", "ridge", "billow")


def profile(shape: Vector) -> Vector:
    """Return a rising H from 0 to 1 through its control points.

    Its increments are exp(sum_j shape_j cos(pi j (i + 1/2) / 10)): zeros give a straight line, the first number bends
    it, the second makes it steep in the middle or at the ends, and so on. Four numbers instead of eleven, and always
    monotone.
    """
    intervals = CURVE_POINTS - 1
    position = (np.arange(intervals) + 0.5) / intervals
    exponent = sum(c * np.cos(math.pi * (j + 1) * position) for j, c in enumerate(shape))
    steps = np.exp(exponent)
    out = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(np.clip(out / out[-1], 0.0, 1.0))


def shape_of(curve: tuple[float, ...]) -> Vector:
    """Return the numbers whose `profile` is nearest to a rising ``curve`` (least squares on log increments)."""
    intervals = CURVE_POINTS - 1
    steps = np.maximum(np.diff(np.asarray(curve)), 0.01)
    position = (np.arange(intervals) + 0.5) / intervals
    # The basis is orthogonal on these midpoints, so each number is a projection.
    logs = np.log(steps)
    found = [2.0 * np.mean(logs * np.cos(math.pi * (j + 1) * position)) for j in range(SHAPE_COUNT)]
    return np.clip(np.array(found), -SHAPE_RANGE, SHAPE_RANGE)


def fold(curve: Vector, how: str) -> Vector:
    """Return ``curve`` folded at its middle height."""
    if how == "none":
        return curve
    bent = np.abs(2.0 * curve - 1.0)
    return 1.0 - bent if how == "ridge" else bent
