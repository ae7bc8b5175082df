"""A detail in words and units, for people."""

from __future__ import annotations

import math
from typing import Any

from voldetail.detail.declaration import Parameter
from voldetail.detail.parameters import PARAMETERS, parameters_of
from voldetail.detail.record import Detail, values_of

_GLOSSY = 0.05  # Ks above which a highlight is worth mentioning: 5 % of the beam, about a dielectric's reflectance
_ANGULAR = 0.5  # facets above which the flat faces are what one sees
MEDIUM_HAS_NONE = ("specular", "shininess", *(p.name for p in parameters_of("pigment")))
"""Numbers of the reflectance that a medium has no use for."""

_COLOURED = {
    "noise": "coloured by example",
    "height": "coloured with its height",
    "hollow": "coloured with its hollows",
    "cell": "coloured by the cell",
}
_STRETCHED = 1.1  # a ratio below this cannot be told from round cells by eye


def describe_in_words(detail: Detail) -> list[tuple[str, str, str, str]]:
    """Label, value, unit and sentence of each parameter, all as text, in the order of their declaration.

    Angles, radians in the file, are given in degrees. What a medium cannot have is left out.
    """
    values = values_of(detail)
    unused = MEDIUM_HAS_NONE if detail.medium is not None else ()
    seen = [p for p in PARAMETERS if p.key in values and p.key.removeprefix("reflectance.") not in unused]
    return [(p.label, *_value(p, values[p.key]), p.sentence) for p in seen]


def summary(detail: Detail) -> str:
    """One sentence that says what the detail is like."""
    noise = detail.noise
    octaves = noise.octaves
    if noise.joining == "highest":
        # What is seen of a stone is about as large as a cell: there is one in each, and they hide each other.
        shape = "angular" if noise.facets > _ANGULAR else "round"
        parts = [f"{shape} stones about {1 / noise.scale:.2g} scene units across"]
        parts += [f"roughened by {octaves - 1} finer octave{'s' * (octaves > 2)}"] * (octaves > 1)
    else:
        counted = "1 octave" if octaves == 1 else f"{octaves} octaves"
        parts = [f"{counted} of {noise.domain} noise with cells about {1 / noise.scale:.2g} scene units across"]
        if noise.has_plates:
            parts.append("broken into plates")
    stretch = max(noise.anisotropy, 1 / noise.anisotropy)
    if stretch >= _STRETCHED:
        # Denser along x means longer across it.
        along = noise.angle + (math.pi / 2 if noise.anisotropy > 1 else 0.0)
        parts.append(f"stretched {stretch:.2g} times along {math.degrees(along) % 180:.0f} degrees")
    if noise.stripe_frequency > 0:
        parts.append(f"striped {noise.stripe_frequency:.2g} times a cell")
    raised = {"displacement": "raised", "volume": "shifting solid matter" if detail.medium is None else "shifting a medium"}
    parts.append(f"{raised[detail.mode]} by up to {detail.relief.amplitude:.2g} scene units")
    if detail.medium is not None:
        parts.append(f"soft over {detail.medium.thickness:.2g}, with an extinction of {detail.medium.extinction:.2g}")
        return ", ".join(parts) + "."
    if detail.colour is not None:
        structure = detail.colour.structure
        parts.append(f"coloured by {structure.model} in two tones" if structure is not None else _COLOURED[detail.colour.driver])
    glossy = detail.reflectance.specular > _GLOSSY
    parts.append(f"glossy (shininess {detail.reflectance.shininess:.2g})" if glossy else "matte")
    return ", ".join(parts) + "."


def _value(declaration: Parameter, value: Any) -> tuple[str, str]:
    if isinstance(value, tuple):
        return " ".join(f"{v:.3g}" for v in value), declaration.unit
    if declaration.unit == "rad":
        return f"{math.degrees(value):.1f}", "degrees"
    if isinstance(value, float):
        return f"{value:.4g}", declaration.unit
    return str(value), declaration.unit
