"""Many studies into one table and one page, on this machine or on a Ray cluster.

>>> from aibo_fit import fleet
>>> fleet.on_ray(["logs/**/study.toml"], out="fits/fleet")

or on a command line: ``python -m aibo_fit.fleet --help``. Folder, table and page are those of ``aibo-fit fleet``, and each
goes on where the other was interrupted.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, List, Optional, Tuple, Union

from . import _cli, _core
from ._ask import _names

if TYPE_CHECKING:
    PathLike = Union[str, "os.PathLike[str]"]

_Answer = Tuple[Optional[str], Optional[str], Optional[str], bool]


def on_ray(
    patterns: Union[PathLike, Iterable[PathLike]],
    *,
    out: PathLike = "fits/fleet",
    address: Optional[str] = "auto",
    without: Iterable[str] = (),
    only: Iterable[str] = (),
    pages: bool = False,
    json: Optional[PathLike] = None,
    progress: Optional[Callable[[str, int, int], Any]] = None,
) -> Tuple[str, bool]:
    """Answers studies as tasks on a Ray cluster, one CPU each, and writes table and page on this machine.

    ``patterns`` are paths, or have ``*`` and ``**``; one may stand alone. The cluster's nodes need this package, and the
    studies and logs under the same paths as here. ``address`` is the cluster's (``auto``: the one that runs here or that
    ``RAY_ADDRESS`` names); where Ray is initialised already it is left as it is. A task whose worker dies is tried once
    more by Ray; if that dies too the study is a row with its error. Each answer is kept as it comes; another run answers
    what is missing or has changed. Gives the text that the program prints, and whether all studies are answered.
    """
    import ray

    without, only = _names(without), _names(only)
    studies = _core.Fleet(_paths(patterns), os.fspath(out), without, only, pages)
    if not ray.is_initialized():
        ray.init(address=address, log_to_driver=False)
    task = ray.remote(num_cpus=1, max_retries=1)(_answered)
    folder, asked = os.getcwd(), (without, only, pages)
    waiting = {task.remote(studies.path(study), folder, *asked): study for study in studies.pending()}
    count = len(waiting)
    while waiting:
        for done in ray.wait(list(waiting), num_returns=1)[0]:
            study = waiting.pop(done)
            try:
                answer = ray.get(done)
            except ray.exceptions.RayError as lost:
                why = str(lost).strip().splitlines() or [type(lost).__name__]
                studies.store_error(study, f"its Ray task was lost, twice: {why[0]}", True)
            else:
                _keep(studies, study, answer)
            if progress is not None:
                progress("studies", count - len(waiting), count)
    return studies.finish(None if json is None else os.fspath(json))


def _paths(patterns: Union[PathLike, Iterable[PathLike]]) -> List[str]:
    if isinstance(patterns, (str, os.PathLike)):
        patterns = [patterns]
    return [os.fspath(one) for one in patterns]


def _answered(study: str, folder: str, without: List[str], only: List[str], pages: bool) -> _Answer:
    """The task: document and page of a study, or why there is none and whether another try may have another outcome."""
    # A task has one CPU; other cores have tasks of their own.
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    # Paths are those of the caller.
    os.chdir(folder)
    import aibo_fit

    try:
        found = aibo_fit.gap(study, without=without, only=only)
    except aibo_fit.Error as error:
        return None, None, str(error), isinstance(error, aibo_fit.Unreadable)
    return found.to_json(), found.to_html() if pages else None, None, False


def _keep(studies: _core.Fleet, study: int, answer: _Answer) -> None:
    document, page, error, may_pass = answer
    if document is None:
        studies.store_error(study, error or "", may_pass)
        return
    if page is not None:
        own = Path(studies.pages_of(study))
        own.mkdir(parents=True, exist_ok=True)
        (own / "report.html").write_text(page, encoding="utf-8")
    studies.store_answer(study, document)


def main(words: Optional[List[str]] = None) -> None:
    """``aibo-fit fleet``, or with ``--ray`` the same on a cluster."""
    words = sys.argv[1:] if words is None else words
    if "--ray" not in words and not {"-h", "--help"} & set(words):
        _cli.main(["fleet", *words])
    parser = argparse.ArgumentParser(
        prog="python -m aibo_fit.fleet",
        description="Diagnose many studies into one table and one page. Without --ray all is as in `aibo-fit fleet`, which "
        "has more options (aibo-fit fleet --help).",
    )
    parser.add_argument("patterns", nargs="+", metavar="PATTERN", help="studies, or patterns in quotes, with * and **")
    parser.add_argument("--ray", action="store_true", help="answer the studies on a Ray cluster, a task for each")
    parser.add_argument("--ray-address", default="auto", metavar="ADDRESS", help="the cluster [default: auto]")
    parser.add_argument("--out", default="fits/fleet", metavar="DIR", help="folder of answers, table and page [default: fits/fleet]")
    parser.add_argument("--json", metavar="FILE", help="write everything that was found as JSON to this file")
    parser.add_argument("--without", default="", metavar="IDS", help="withhold effects, separated by commas")
    parser.add_argument("--only", default="", metavar="IDS", help="consider these effects only")
    parser.add_argument("--pages", action="store_true", help="write each study's own report too")
    parser.add_argument("-q", "--quiet", action="store_true", help="no text on standard output, no progress")
    asked = parser.parse_args(words)
    is_shown = sys.stderr.isatty() and not asked.quiet

    def progress(stage: str, done: int, of: int) -> None:
        print(f"\r{done} of {of} {stage}", end="\n" if done == of else "", file=sys.stderr, flush=True)

    try:
        text, is_whole = on_ray(
            asked.patterns,
            out=asked.out,
            address=asked.ray_address,
            without=_ids(asked.without),
            only=_ids(asked.only),
            pages=asked.pages,
            json=asked.json,
            progress=progress if is_shown else None,
        )
    except ImportError:
        parser.exit(2, "error: --ray needs the package `ray`: pip install ray\n")
    except (_core.Error, ConnectionError) as error:
        parser.exit(2, f"error: {error}\n")
    if not asked.quiet:
        print(text, end="")
    sys.exit(0 if is_whole else 1)


def _ids(words: str) -> List[str]:
    return [word.strip() for word in words.split(",") if word.strip()]


if __name__ == "__main__":
    main()
