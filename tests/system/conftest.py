"""What all tests of whole commands share."""

import pytest

from voldetail.cli import fit_relief

SMALL_RELIEF = 64
"""Pixels of the relief that a fit keeps beside its detail: tests of fits have one, and tests of reliefs look at it closely."""


@pytest.fixture(autouse=True)
def _small_relief(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fit_relief, "SIZE", SMALL_RELIEF)
