"""Every public name of the Python interface shows how it is used, and the example runs."""

import doctest
import inspect
from types import ModuleType

import pytest

from voldetail import api
from voldetail.api import files, fitting, inputs, measuring, showing

MODULES = (api, files, fitting, inputs, measuring, showing)


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_the_examples_run(module: ModuleType) -> None:
    done = doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert done.failed == 0
    assert done.attempted > 0


def test_every_name_is_there_and_says_what_it_is() -> None:
    for name in api.__all__:
        thing = getattr(api, name)
        if inspect.isfunction(thing) or inspect.isclass(thing):
            assert inspect.getdoc(thing), name
            if inspect.isfunction(thing):
                assert inspect.signature(thing).return_annotation is not inspect.Signature.empty, name
                kinds = {p.kind for p in inspect.signature(thing).parameters.values()}
                assert inspect.Parameter.VAR_KEYWORD not in kinds, f"{name} takes any keyword"
