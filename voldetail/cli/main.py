"""The entry point: runs a command and turns whatever goes wrong into one sentence and an exit code."""

from __future__ import annotations

import errno
import os
import sys
import time
import traceback
from collections.abc import Sequence

from typer.main import get_command

from voldetail.cli.app import app
from voldetail.cli.console import MANNER, explain
from voldetail.errors import VoldetailError

MANNERS = ("--json", "--quiet", "--verbose", "--debug")
"""Words that any command takes, at any place."""

DONE, FAILED, BAD_INPUT, STOPPED = 0, 1, 2, 130  # 130 = 128 + SIGINT, as shells report it


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line (default: the process's own) and return the exit code.

    0 done; 2 bad input or output, told in one sentence on the error stream; 130 stopped with Ctrl-C; 1 a
    defect of voldetail itself. `--debug` shows the traceback as well. Words that say how a command speaks stand before or
    after it.
    """
    whole = list(sys.argv[1:] if arguments is None else arguments)
    # What stands behind "--" is a file's name, whatever it looks like.
    end = whole.index("--") if "--" in whole else len(whole)
    asked, names = whole[:end], whole[end:]
    given = [*(word for word in asked if word not in MANNERS), *names]
    debug = "--debug" in asked
    MANNER.quiet, MANNER.verbose, MANNER.as_json = (word in asked for word in ("--quiet", "--verbose", "--json"))
    MANNER.threads, begun = 0, time.monotonic()
    try:
        code = get_command(app).main(given, prog_name="voldetail", standalone_mode=False)
        explain(f"Done in {time.monotonic() - begun:.1f} s.")
        sys.stdout.flush()
        return code if isinstance(code, int) else DONE
    except SystemExit as leaving:  # how the parser ends after a reader went away
        return leaving.code if isinstance(leaving.code, int) else FAILED
    except BrokenPipeError:
        # The reader of our output (`| head`) has what it wanted; Python's flush at exit must not complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except BaseException as error:
        if debug:
            traceback.print_exc()
        code, sentence = _judge(error)
        if sentence:
            print(f"voldetail: {sentence}", file=sys.stderr)
        return code


def _judge(error: BaseException) -> tuple[int, str]:
    """Exit code and sentence for an error."""
    if isinstance(error, VoldetailError):
        return BAD_INPUT, _line(error)
    if isinstance(error, KeyboardInterrupt) or type(error).__name__ == "Abort":
        return STOPPED, "stopped."
    if type(error).__name__ == "NoArgsIsHelpError":
        return DONE, ""
    if hasattr(error, "format_message"):  # the parser's own; where its class lives depends on typer's version
        text = " ".join(str(error.format_message()).split()).rstrip(".")
        return BAD_INPUT, f"{text}; see voldetail --help."
    if isinstance(error, OSError):
        reason = error.strerror or str(error) or type(error).__name__
        where = f" ({error.filename})" if error.filename else ""
        hint = "free some space" if error.errno in (errno.ENOSPC, errno.EDQUOT) else "check the path and its permissions"
        return BAD_INPUT, f"{reason}{where}; {hint} and try again."
    if isinstance(error, MemoryError):
        return BAD_INPUT, "There is not enough memory; use a smaller --size, --resolution or mesh."
    return (
        FAILED,
        f"unexpected {type(error).__name__}: {_line(error)}; run again with --debug and report what it says.",
    )


def _line(error: BaseException) -> str:
    return " ".join(str(error).split())
