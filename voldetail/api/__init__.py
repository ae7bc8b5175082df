"""The Python interface: what the commands do, with texts, files, arrays and records alike.

>>> from voldetail.api import fit, render
>>> result = fit("skimage:gravel", light="70,50", zone=(0, 0, 96, 96), resolution=64, fit={"evaluations": 8}, colour="none")
>>> result.detail.mode
'displacement'
>>> render(result.detail, "sphere", light="135,40", size=(48, 48)).shape
(48, 48, 3)
"""

from voldetail.api.files import load_detail, load_mesh, load_photo, load_setup, save_detail, save_image
from voldetail.api.fitting import fit
from voldetail.api.inputs import LightLike, ShapeLike, as_light
from voldetail.api.measuring import compare, describe
from voldetail.api.recovering import recover, save_relief, tile
from voldetail.api.showing import bake, export, gallery, relight, render, write_report
from voldetail.detail import Detail
from voldetail.errors import InputError, VoldetailError
from voldetail.fit import Progress
from voldetail.image import MaskLike, Photo, PhotoLike, luminance
from voldetail.metric import Descriptor, distance, distance_by_level
from voldetail.recover.recovery import Recovery
from voldetail.results import FitResult, Gallery
from voldetail.setup.camera import CameraSetup
from voldetail.setup.fit_settings import FitSettings
from voldetail.setup.light import Light, parse_light
from voldetail.setup.photo import PhotoSetup
from voldetail.setup.proxy import ProxySetup
from voldetail.setup.setup import Setup

__all__ = [
    "CameraSetup",
    "Descriptor",
    "Detail",
    "FitResult",
    "FitSettings",
    "Gallery",
    "InputError",
    "Light",
    "LightLike",
    "MaskLike",
    "Photo",
    "PhotoLike",
    "PhotoSetup",
    "Progress",
    "ProxySetup",
    "Recovery",
    "Setup",
    "ShapeLike",
    "VoldetailError",
    "as_light",
    "bake",
    "compare",
    "describe",
    "distance",
    "distance_by_level",
    "export",
    "fit",
    "gallery",
    "load_detail",
    "load_mesh",
    "load_photo",
    "load_setup",
    "luminance",
    "parse_light",
    "recover",
    "relight",
    "render",
    "save_detail",
    "save_image",
    "save_relief",
    "tile",
    "write_report",
]
