"""
Relief from one photograph
==========================

Ten seconds of searching from nothing, on scikit-image's gravel at 96 pixels.
"""

# %%
# The photo, the light in it (azimuth and elevation in degrees) and the part of it that is fitted. So short a search ends in
# other kinds of noise for other seeds; a whole fit compares more pictures and starts from a library of reliefs.

from voldetail.api import fit

result = fit(
    "skimage:gravel", light="70,50", zone=(160, 160, 192, 192), resolution=96, colour="none", seed=3,
    fit={"evaluations": 600, "library": "none"},
)  # fmt: skip
print(f"M = {result.distance:.2f} after {result.evaluations} pictures; {result.status}")

# %%
# The photo, the fit under the photo's light, and the fit on a sphere with the light from the left. The stones are others on
# purpose: what is alike are their statistics.

import matplotlib.pyplot as plt
import numpy as np

from voldetail.api import render
from voldetail.image import resize, to_srgb

sphere = render(result.detail, "sphere", light="160,35", size=(300, 300), background=1.0)
photo, fitted = (resize(np.asarray(picture), (300, 300)) for picture in (result.target.pixels, result.coloured))

plt.figure(figsize=(9, 3.2), layout="constrained")
plt.imshow(to_srgb(np.hstack([photo, fitted, sphere])).clip(0, 1))
plt.axis("off")

# %%
# The detail is a frozen record of some forty numbers, which :func:`voldetail.api.save_detail` writes as JSON.

from voldetail.detail import summary

print(summary(result.detail))
