"""Where each equation and section of the papers is in the code: read from what the modules themselves cite."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections import defaultdict
from functools import cache
from pathlib import Path

import voldetail
from from_code.bibliography import OTHERS, PAPERS, Work
from from_code.markdown import code, plain, table

PACKAGE = Path(voldetail.__file__).parent

_PLACE = re.compile(
    r"\b(?P<kind>eq\.|equations?|sections?|algorithm|figure) "
    r"(?P<numbers>\d+(?:\.\d+)?(?: to \d+\b(?! cycles))?(?:(?:, \d+(?:\.\d+)?)*,? and \d+(?:\.\d+)?)?)",
    re.IGNORECASE,
)
_SHORT = re.compile(r"\b(" + "|".join(PAPERS) + r")\b")
_YEAR = re.compile(r"\b(?:19[3-9]\d|20[0-2]\d)\b(?! article| report)")
_SENTENCE = re.compile(r"(?<=[.;:)])(?<!eq\.)(?<!al\.)\s|\n\n", re.IGNORECASE)


def papers_page(short: str) -> str:
    """Return the table of a paper's places: the place, what it is, and the modules that cite it."""
    where = cited()[short]
    rows = [
        (place, plain(what), ", ".join(code(module) for module in sorted(where[place])))
        for place, what in PAPERS[short].places.items()
    ]  # fmt: skip
    return table(["where", "what", "modules"], rows)


def other_papers_page() -> str:
    """Return the table of all other works that the code cites."""
    rows = [
        (plain(f"{work.authors}, {work.year}"), plain(work.what), ", ".join(map(code, sorted(modules))))
        for work, modules in others().items()
    ]  # fmt: skip
    return table(["work", "for", "modules"], rows)


@cache
def cited() -> dict[str, dict[str, set[str]]]:
    """Return, for each paper and place such as "eq. 2", the modules that name it."""
    found: dict[str, dict[str, set[str]]] = {short: defaultdict(set) for short in PAPERS}
    for name, text in prose().items():
        own = paper_of(text)
        for sentence in _SENTENCE.split(text):
            for match in _PLACE.finditer(sentence):
                paper = _paper_before(sentence[: match.start()], own)
                for place in _places(match["kind"], match["numbers"]) if paper else ():
                    found[paper][place].add(name)
    return found


def others() -> dict[Work, set[str]]:
    """Return, for each other work, the modules that name its first author and, not far behind, its year."""
    return {
        work: {name for name, text in prose().items() if re.search(rf"\b{work.surname}\b[^;]{{0,160}}?\b{work.year}\b", text)}
        for work in OTHERS
    }


@cache
def prose() -> dict[str, str]:
    """Return the docstrings, other texts and comments of every module, by its name without "voldetail."."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        strings = [n.value for n in ast.walk(ast.parse(source)) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
        comments = [t.string for t in tokenize.generate_tokens(io.StringIO(source).readline) if t.type == tokenize.COMMENT]
        parts = [" ".join(part.split()) for text in [*strings, *comments] for part in text.split("\n\n")]
        found[".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__")] = "\n\n".join(parts)
    return found


def paper_of(text: str) -> str:
    """Return the paper whose short name or title a module has first; "" where it has none."""
    names = [(text.find(name), short) for short, paper in PAPERS.items() for name in (short, paper.title)]
    return min(((at, short) for at, short in names if at >= 0), default=(0, ""))[1]


def _paper_before(before: str, own: str) -> str:
    """Return the paper of a place: the last work named before it in its sentence, else ``own``; "" for another work's."""
    if "DESIGN" in before:
        return ""
    shorts, years = list(_SHORT.finditer(before)), list(_YEAR.finditer(before))
    if years and not (shorts and shorts[-1].start() > years[-1].start()):
        return own if own and PAPERS[own].title in before else ""
    return shorts[-1].group() if shorts else own


def _places(kind: str, numbers: str) -> list[str]:
    """Return "equations", "1 to 3 and 5" as "eq. 1", "eq. 2", "eq. 3", "eq. 5"."""
    word = "eq." if kind.lower().startswith("eq") else kind.lower().removesuffix("s")
    found: list[str] = []
    for part in re.split(r", (?:and )?| and ", numbers):
        first, _, last = part.partition(" to ")
        found += [first] if not last else [str(k) for k in range(int(first), int(last) + 1)]
    return [f"{word} {number}" for number in found]
