"""Your own recordings: read from the formats of robots and tools, cleaned, and written to them."""

from tpsim.data.cleaning import aligned as aligned
from tpsim.data.cleaning import resampled as resampled
from tpsim.data.cleaning import smoothed as smoothed
from tpsim.data.cleaning import trimmed as trimmed
from tpsim.data.columns import Columns as Columns
from tpsim.data.columns import PoseColumns as PoseColumns
from tpsim.data.frames import frames_from as frames_from
from tpsim.data.poses import poses_in as poses_in
from tpsim.data.reading import FORMATS as FORMATS
from tpsim.data.reading import read as read
from tpsim.data.reading import recordings as recordings
from tpsim.data.recording import Recording as Recording
from tpsim.data.recording import Series as Series
from tpsim.data.segments import segmented as segmented
from tpsim.data.writers.lerobot import write_lerobot as write_lerobot
from tpsim.data.writers.mcap import write_mcap as write_mcap
from tpsim.data.writers.robomimic import write_robomimic as write_robomimic
from tpsim.data.writers.table import write_csv as write_csv
from tpsim.data.writing import write as write
