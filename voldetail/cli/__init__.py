"""The command line: chooses paths, prints, shows progress. The work is done elsewhere."""

from voldetail.cli.main import main

__all__ = ["main"]
