"""Your own recordings: read from the formats of robots and tools, cleaned, and written to them."""

from tpsim.data.columns import Columns as Columns
from tpsim.data.columns import PoseColumns as PoseColumns
from tpsim.data.frames import frames_from as frames_from
from tpsim.data.poses import poses_in as poses_in
from tpsim.data.reading import FORMATS as FORMATS
from tpsim.data.reading import read as read
from tpsim.data.reading import recordings as recordings
from tpsim.data.recording import Recording as Recording
from tpsim.data.recording import Series as Series
