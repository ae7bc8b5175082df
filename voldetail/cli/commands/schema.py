"""`voldetail schema`: the form of all detail files."""

from __future__ import annotations

import json

from voldetail.detail import schema as detail_schema


def schema() -> None:
    """Print the JSON schema of detail files."""
    print(json.dumps(detail_schema(), indent=2, ensure_ascii=False))
