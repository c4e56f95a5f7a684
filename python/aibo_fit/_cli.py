"""The program that comes with the package."""

import signal
import sys
from typing import Optional, Sequence

from . import _core


def main(words: Optional[Sequence[str]] = None) -> None:
    """Runs ``aibo-fit`` on these words, or on this process's command line."""
    # Ctrl-C ends the program at once, as it does the one without Python.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # Where it needs processes of its own they begin so; the working folder is no place to look for modules.
    apart = ["-P"] if sys.version_info >= (3, 11) else []
    program = [sys.executable, *apart, "-m", "aibo_fit._cli"]
    # Cut output (``| head``) is no error; the program notices by itself.
    sys.exit(_core.main(program, ["aibo-fit", *(sys.argv[1:] if words is None else words)]))


if __name__ == "__main__":
    main()
