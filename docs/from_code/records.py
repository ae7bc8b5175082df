"""Frozen records and the parameters of a detail as tables."""

from __future__ import annotations

import importlib
import json
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from from_code.markdown import code, plain, table
from voldetail.detail import PARAMETERS, Detail, detail_to_text
from voldetail.records import refusal

GROUPS = {"noise": "Noise", "relief": "Relief", "reflectance": "Reflectance", "medium": "Medium (of a volume only)"}


def parameter_page() -> str:
    """Return a table of the parameters for each group of a detail file."""
    pieces = []
    for group, title in GROUPS.items():
        rows = [
            (code(p.key.split(".")[1]), plain(p.symbol), plain(p.allowed), plain(_default(p.default)), plain(p.sentence))
            for p in PARAMETERS if p.key.startswith(group + ".")
        ]  # fmt: skip
        pieces += [f"**{title}: `{group}`**\n", table(["name", "symbol", "allowed", "default", "meaning"], rows)]
    left_out = sorted({p.key.split(".")[0] for p in PARAMETERS} - set(GROUPS))
    if left_out:
        raise ValueError(f"groups without a title: {left_out}")
    return "\n".join(pieces)


def layout_page() -> str:
    """Return a whole detail file, the default detail's, as it is written."""
    return f"```json\n{detail_to_text(Detail()).rstrip()}\n```\n"


def record_page(path: str) -> str:
    """Return the fields of the record "voldetail.module.Name": name, what is allowed, default, sentence."""
    module, _, name = path.rpartition(".")
    record: type[BaseModel] = getattr(importlib.import_module(module), name)
    rows = [(code(key), plain(_allowed(field)), _field_default(field), plain(field.description or ""))
            for key, field in record.model_fields.items()]  # fmt: skip
    return table(["key", "allowed", "default", "meaning"], rows)


def _allowed(field: FieldInfo) -> str:
    return refusal._allowed(field)


def _default(value: Any) -> str:
    return ", ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else str(value)


def _field_default(field: FieldInfo) -> str:
    if field.is_required():
        return "needed"
    value = field.default
    if field.default_factory is not None or isinstance(value, BaseModel):
        return "its own"
    return code(json.dumps(value, default=str))
