"""How many processor threads the renderer may use."""

from __future__ import annotations


def use_threads(count: int | None) -> None:
    """Limit the renderer to ``count`` threads; 0 or None leaves it all of them."""
    if count:
        from voldetail.backend import set_threads

        set_threads(count)
