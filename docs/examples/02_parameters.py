"""
What the parameters do
======================

Details need no photo: any of their numbers can be set by hand. Nine planes under one light from the upper left.
"""

# %%
# Each differs from the default detail in the numbers that its title names.

import matplotlib.pyplot as plt

from voldetail.api import Detail, render
from voldetail.detail import with_values
from voldetail.image import to_srgb

EVERY = {"noise.scale": 6.0, "relief.amplitude": 0.1, "reflectance.diffuse": 0.8}
EVEN = {"noise.first_neighbour": 1, "noise.last_neighbour": 50}
CHOICES = {
    "closest two points": {},
    "all points": EVEN,
    "second alone": {"noise.first_neighbour": 2},
    "five octaves": EVEN | {"noise.octaves": 5},
    "three times as fine": {"noise.scale": 18.0, "relief.amplitude": 0.04},
    "anisotropy 4": EVEN | {"noise.anisotropy": 4.0, "noise.angle": 0.5},
    "stripes": EVEN | {"noise.stripe_frequency": 2.0, "noise.octaves": 1},
    "stones": EVEN | {"noise.joining": "highest", "noise.facets": 0.7, "noise.size_spread": 0.5, "noise.octaves": 1},
    "plates": {"noise.cell_height": 1.0, "noise.cell_tilt": 1.0, "noise.bevel": 0.1, "noise.weights": (1.0, -1.0, 0.0)},
}

_, axes = plt.subplots(3, 3, figsize=(9, 9.6), layout="constrained")
for axis, (title, values) in zip(axes.flat, CHOICES.items(), strict=True):
    detail = with_values(Detail(), EVERY | values)
    axis.imshow(to_srgb(render(detail, "plane", light="135,40", size=(160, 160))).clip(0, 1))
    axis.set_title(title)
    axis.set_axis_off()
