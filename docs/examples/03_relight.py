"""
Other shapes, other lights
==========================

One detail on four shapes, and a light that goes round it.
"""

# %%
# A detail of stones, set by hand; one of a fit goes the same way.

import matplotlib.pyplot as plt
import numpy as np

from voldetail.api import Detail, relight, render
from voldetail.detail import with_values
from voldetail.image import to_srgb

stones = with_values(Detail(), {
    "noise.first_neighbour": 1, "noise.last_neighbour": 50, "noise.joining": "highest", "noise.facets": 0.6,
    "noise.size_spread": 0.4, "noise.octaves": 2, "noise.scale": 7.0, "relief.amplitude": 0.09, "reflectance.ambient": 0.05,
    "reflectance.diffuse": 0.7, "reflectance.cell_albedo": 0.4,
})  # fmt: skip


def in_a_row(pictures):
    """Show linear pictures beside each other."""
    plt.figure(figsize=(9, 2.5), layout="constrained")
    plt.imshow(to_srgb(np.hstack(pictures)).clip(0, 1))
    plt.axis("off")


# %%
# The relief goes along the normal of whatever shape it is put on: the solid noise needs no texture coordinates.

turns = {"sphere": (0.0, 0.0, 0.0), "cylinder": (20.0, 0.0, 15.0), "box": (25.0, -35.0, 0.0), "torus": (-50.0, 0.0, 20.0)}
in_a_row([
    render(stones, shape, light="150,40", size=(160, 160), rotation=turn, background=1.0) for shape, turn in turns.items()
])  # fmt: skip

# %%
# :func:`voldetail.api.relight` makes the geometry once and renders it under every light.

frames = relight(stones, "sphere", azimuths=(0, 90, 180, 270), elevations=(25,), size=(160, 160), background=1.0)
in_a_row([picture for _, _, picture in frames])

# %%
# A work light near the surface: a cone of 20 degrees to each side, aimed at the middle.

in_a_row([
    render(stones, "plane", light=light, size=(160, 160)) for light in ("flash", "point:-1,1,0.7", "spot:-1.2,1.2,1.2@0,0,0,20")
])  # fmt: skip
