"""A sphere: an ellipsoid of equal axes, unless it is given others."""

from voldetail.geometry.primitives.ellipsoid import Ellipsoid

PRIMITIVE = Ellipsoid
