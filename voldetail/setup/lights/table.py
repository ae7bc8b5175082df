"""The kinds of light, a row each; texts are tried from the top, and what is left over is a direction."""

from __future__ import annotations

from typing import Literal

from voldetail.setup.lights.auto import Auto
from voldetail.setup.lights.directional import Directional
from voldetail.setup.lights.flash import Flash
from voldetail.setup.lights.kind import LightKind
from voldetail.setup.lights.point import Point
from voldetail.setup.lights.spot import Spot

LightName = Literal["directional", "point", "spot", "flash", "auto"]

LIGHTS: dict[str, LightKind] = {light.name: light for light in (Auto(), Flash(), Point(), Spot(), Directional())}

ORDER = ("directional", "flash", "point", "spot")
"""In which forms are listed for users."""


def _listed(forms: list[str]) -> str:
    return ", ".join(forms[:-1]) + f" or {forms[-1]}"


FORMS_GIVEN = _listed([form for name in ORDER for form in LIGHTS[name].forms])
FORMS = FORMS_GIVEN + ", or auto to have it estimated"
FORMS_PLACED = _listed([form for name in ORDER if name != "flash" for form in LIGHTS[name].forms])
"""Forms that need no photo."""
