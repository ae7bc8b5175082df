"""Kinds of light, of shape and of metric: the rows of their tables, each with its own sentence."""

from __future__ import annotations

import inspect
from importlib import import_module

from from_code.markdown import code, plain, table
from voldetail.export import FORMATS
from voldetail.metric.descriptor import METRICS
from voldetail.metric.ingredients import COMBINED, INGREDIENTS
from voldetail.setup.lights.table import LIGHTS
from voldetail.setup.shapes import SHAPES


def lights_page() -> str:
    """Return the forms of a light's text, and what each is."""
    rows = [(" ".join(map(code, light.forms)), code(light.name), plain(sentence_of(type(light)))) for light in LIGHTS.values()]
    return table(["text", "kind", "light"], rows)


def shapes_page() -> str:
    """Return the kinds of shape with the sizes that they have where none is given."""
    rows = []
    for kind, row in SHAPES.items():
        shape = import_module(f"voldetail.geometry.primitives.{kind}").PRIMITIVE
        rows.append((code(kind), " x ".join(f"{side:g}" for side in row.size), plain(sentence_of(shape))))
    return table(["kind", "size, scene units", "shape"], rows)


def formats_page() -> str:
    """Return the formats that a detail on a shape is written in."""
    return table(["suffix", "what is in the file"], [(" ".join(map(code, row.suffixes)), plain(row.what)) for row in FORMATS])


def metrics_page() -> str:
    """Return the metrics: the sum, and each ingredient with its share of it."""
    rows = [(code("combined"), "", "the weighted mean of those with a share, each in units of its noise floor")]
    for name in METRICS:
        if name in INGREDIENTS:
            share = sum(COMBINED.get(name, {}).values())
            document = inspect.getdoc(INGREDIENTS[name]) or ""
            rows.append((code(name), f"{share:.2f}" if share else "", plain(first_sentence(document))))
    return table(["metric", "share of combined", "what it compares"], rows)


def sentence_of(kind: type) -> str:
    """Return the first sentence of a class."""
    return first_sentence(inspect.getdoc(kind) or "")


def first_sentence(document: str) -> str:
    """Return the first line of a docstring."""
    return document.split("\n\n")[0].replace("\n", " ")
