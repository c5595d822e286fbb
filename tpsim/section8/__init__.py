"""Section 8 as a table: which task-adaptive method generalises, how far, and how fast."""

from tpsim.section8.comparison import compare as compare
from tpsim.section8.left_out import compare_left_out as compare_left_out
from tpsim.section8.measures import measure as measure
from tpsim.section8.method import Learned as Learned
from tpsim.section8.methods import METHODS as METHODS
