"""Turns logs of robot joints into trustworthy dynamics, and explains the gap between a model and a robot.

Arrays or files go in, typed answers come out. All quantities are SI: s, rad, rad/s, N m, kg m^2, kg m.

>>> import aibo_fit
>>> found = aibo_fit.gap("study.toml")
>>> found.verdict, found.probability
>>> found.save_html("report.html")

The same questions can be asked on a command line: ``aibo-fit --help``.
"""

from ._ask import check, drop, gap
from ._core import Error, NeverMoved, Unreadable, __version__
from ._results import Check, Drop, Gap
from ._robot import Robot

__all__ = ["Check", "Drop", "Error", "Gap", "NeverMoved", "Robot", "Unreadable", "__version__", "check", "drop", "gap"]
