"""
A tile that repeats unseen
==========================

How even a photo is, and a tile of it without seams.
"""

# %%
# The gravel at half its size, darkened towards one side as a badly lit photo is.

import matplotlib.pyplot as plt
import numpy as np

from voldetail.api import load_photo
from voldetail.image import resize, to_srgb
from voldetail.stationary.measure import stationarity
from voldetail.stationary.tile import stationarize

gravel = resize(load_photo("skimage:gravel").pixels, (256, 256))
photo = gravel * np.linspace(0.2, 1.0, 256, dtype=np.float32)[None, :, None]

tile = stationarize(photo, size=128)
before, after = stationarity(photo).value, stationarity(tile.tile, toroidal=True).value
print(f"deviation from evenness by local histograms: photo {before:.3f}, tile {after:.3f}")

# %%
# The photo beside the tile, twice two of it.

plt.figure(figsize=(9, 4.6), layout="constrained")
plt.imshow(to_srgb(np.hstack([photo, np.ones((256, 8, 3)), np.tile(tile.tile, (2, 2, 1))])))
plt.axis("off")
