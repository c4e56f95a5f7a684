"""The program that comes with the package."""

import signal
import sys

from . import _core


def main() -> None:
    """Runs ``aibo-fit`` on this process's command line."""
    # Ctrl-C ends the program at once, as it does the one without Python.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    # Cut output (``| head``) is no error; the program notices by itself.
    sys.exit(_core.main(["aibo-fit", *sys.argv[1:]]))
