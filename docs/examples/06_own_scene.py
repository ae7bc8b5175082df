"""
In a Mitsuba scene of one's own
===============================

A colour texture as the Mitsuba texture `voldetail_colour`, which any BSDF takes.
"""

# %%
# `mitsuba()` picks the variant and the LLVM; the texture is evaluated at points in space, so that no texture coordinates are
# needed.

import matplotlib.pyplot as plt
import numpy as np
import skimage

from voldetail.api import load_photo
from voldetail.backend import mitsuba
from voldetail.image import to_srgb
from voldetail.render.plugins.colour import colour_dict
from voldetail.texture import analyse

mi = mitsuba()
tissue = analyse(load_photo(skimage.data.immunohistochemistry()).pixels[:256, :256], name="tissue")

scene = mi.load_dict({
    "type": "scene",
    "integrator": {"type": "path", "max_depth": 3},
    "sensor": {
        "type": "perspective", "fov": 30.0,
        "to_world": mi.ScalarTransform4f().look_at(origin=(0, -9, 4), target=(0, 0, 0.7), up=(0, 0, 1)),
        "film": {"type": "hdrfilm", "width": 360, "height": 240},
        "sampler": {"type": "independent", "sample_count": 16},
    },
    "sky": {"type": "constant", "radiance": 0.6},
    "sun": {"type": "directional", "direction": (1.0, 1.0, -1.5), "irradiance": 2.0},
    "ball": {
        "type": "sphere", "center": (-1.1, 0.0, 1.0), "radius": 1.0,
        "bsdf": {"type": "diffuse", "reflectance": colour_dict(tissue, texels_per_unit=96.0)},
    },
    "block": {
        "type": "cube", "to_world": mi.ScalarTransform4f().translate((1.2, 0.3, 0.8)).rotate((0, 0, 1), 30).scale(0.8),
        "bsdf": {"type": "roughplastic", "diffuse_reflectance": colour_dict(tissue, texels_per_unit=192.0)},
    },
    "floor": {
        "type": "rectangle", "to_world": mi.ScalarTransform4f().scale(8.0),
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}},
    },
})  # fmt: skip

# %%
# The texture goes through each body: cut it anywhere, the pattern is there.

plt.figure(figsize=(9, 6), layout="constrained")
plt.imshow(to_srgb(np.array(mi.render(scene))[..., :3]).clip(0, 1))
plt.axis("off")
