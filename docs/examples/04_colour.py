"""
A texture of colour, by example
===============================

Some seventy numbers of one picture: endless, edited by bands of wavelengths, and morphed into another.
"""

# %%
# The example is scikit-image's micrograph of stained tissue. Pictures inside voldetail are linear light.

import matplotlib.pyplot as plt
import numpy as np
import skimage

from voldetail.api import load_photo
from voldetail.image import to_srgb
from voldetail.texture import analyse, edit, morph, picture

photo = load_photo(skimage.data.immunohistochemistry()).pixels[:256, :256]
texture = analyse(photo, name="tissue", directed=False)


def in_a_row(*pictures):
    """Show linear pictures beside each other."""
    plt.figure(figsize=(9, 3.2), layout="constrained")
    plt.imshow(to_srgb(np.hstack(pictures)).clip(0, 1))
    plt.axis("off")


# %%
# The photo, and a picture of the numbers, twice as wide, that starts a thousand texels away. Colours, their sizes and their
# shares are the photo's; shapes are not.

in_a_row(photo, picture(texture, (512, 256), offset=(1000.0, 0.0)))

# %%
# Coarse bands twice as strong; fine ones taken out; less contrast. The histogram stays where contrast is not changed.

in_a_row(
    picture(edit(texture, {"coarse": 2.0}), (256, 256)),
    picture(edit(texture, {"fine": 0.0}), (256, 256)),
    picture(edit(texture, contrast=0.5), (256, 256)),
)

# %%
# Halfway between the tissue and gravel.

gravel = analyse(load_photo("skimage:gravel").pixels[:256, :256], name="gravel", directed=False)
in_a_row(*(picture(morph(texture, gravel, t), (256, 256)) for t in (0.25, 0.5, 0.75)))
