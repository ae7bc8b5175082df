"""Shared fixtures."""

from pathlib import Path

import pytest

SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real test data beside the repository; the test skips where it is missing."""
    if not SHARED_DATA.is_dir():
        pytest.skip("the real test data (../shared/data) is not beside this checkout")
    return SHARED_DATA
