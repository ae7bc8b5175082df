"""The fitted Phong reflectance beside the physically based one that stands for it.

Run with:  python -m tests.benchmarks.shading -o results/shading
Left to right: phong (as fitted, light and sky evaluated without noise), principled (path-traced), eight times their
difference. Top: matt; bottom: with a highlight. The numbers are mean luminances inside the sphere.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks.kept import keep_linear
from voldetail.apply import render
from voldetail.detail import Detail, with_values
from voldetail.files import write_text
from voldetail.image import luminance
from voldetail.setup.light import parse_light

SIDE = 256
CASES = {
    "matt": {"reflectance.specular": 0.0},
    "glossy": {"reflectance.specular": 0.1, "reflectance.shininess": 40.0, "reflectance.diffuse": 0.3},
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/shading"))
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    base = with_values(Detail(), {"noise.scale": 8.0, "relief.amplitude": 0.04})
    rows, record = [], {}
    for name, values in CASES.items():
        detail = with_values(base, values)
        light = parse_light("135,45")
        options: dict[str, Any] = {"light": light, "size": (SIDE, SIDE)}
        phong = render(detail, "sphere", **options)
        principled = render(detail, "sphere", shading="principled", samples=128, **options)
        rows.append(np.concatenate([phong, principled, np.clip(8 * np.abs(phong - principled), 0, 1)], axis=1))
        one, other = luminance(phong), luminance(principled)
        inside = (one > 0) | (other > 0)
        record[name] = {
            "mean_phong": round(float(one[inside].mean()), 4),
            "mean_principled": round(float(other[inside].mean()), 4),
            "mean_difference": round(float(np.abs(one - other)[inside].mean()), 4),
        }
    keep_linear(arguments.output / "phong_principled.jpg", np.concatenate(rows))
    write_text(arguments.output / "shading.json", json.dumps(record, indent=1) + "\n")
    print(json.dumps(record, indent=1))


if __name__ == "__main__":
    main()
