"""Every benchmark can at least be imported: what README's commands name must not be found broken only when it is run."""

import importlib
import pkgutil

import pytest

from tests import benchmarks

NAMES = sorted(module.name for module in pkgutil.walk_packages(benchmarks.__path__, "tests.benchmarks."))


@pytest.mark.parametrize("name", NAMES)
def test_it_can_be_imported(name: str) -> None:
    importlib.import_module(name)
