"""The starting set of profiles H: classical functions, as in GD10 figure 4, monotone ones first."""

from collections.abc import Callable

from voldetail.detail.parameters import CURVE_POINTS


def sampled(function: Callable[[float], float]) -> tuple[float, ...]:
    """`function` of t at the control points of H, equally spaced over [-1, 1], to 7 digits."""
    last = CURVE_POINTS - 1
    return tuple(round(function(2 * i / last - 1), 7) for i in range(CURVE_POINTS))


def _unit(t: float) -> float:
    return min(max((t + 1) / 2, 0.0), 1.0)


def _smoothstep(u: float) -> float:
    u = min(max(u, 0.0), 1.0)
    return u * u * (3 - 2 * u)


_STEP_STEEPNESS = 2.5  # rises within the middle 1 / 2.5 of the range: as steep as 11 points can follow

START_CURVES: dict[str, tuple[float, ...]] = {
    "linear": sampled(_unit),
    "square": sampled(lambda t: _unit(t) ** 2),
    "root": sampled(lambda t: _unit(t) ** 0.5),
    "smoothstep": sampled(lambda t: _smoothstep(_unit(t))),
    "step": sampled(lambda t: _smoothstep(0.5 + _STEP_STEEPNESS * t / 2)),
    "ramp": sampled(lambda t: max(t, 0.0)),
    "plateau": sampled(lambda t: min(t + 1, 1.0)),
    "billow": sampled(abs),
    "ridge": sampled(lambda t: 1 - abs(t)),
}

MONOTONE_CURVES: tuple[str, ...] = ("linear", "square", "root", "smoothstep", "step", "ramp", "plateau")
