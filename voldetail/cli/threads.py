"""How many processor threads the renderer may use."""

from __future__ import annotations

from voldetail.cli.console import MANNER


def use_threads() -> None:
    """Limit the renderer to the threads that the user gave; 0 leaves it all of them."""
    if MANNER.threads:
        from voldetail.backend import set_threads

        set_threads(MANNER.threads)
