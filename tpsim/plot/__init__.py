"""Pictures in the style of the tutorial: frames, Gaussians, movements, arms; one palette, one ink.

Everything draws into a Matplotlib ``Axes`` that the caller owns, so the functions combine with any
other plot::

    from matplotlib.figure import Figure
    from tpsim import plot

    figure = Figure()
    (axis,) = plot.panels(figure)
    plot.demonstrations(axis, demonstrations)
    plot.tube(axis, path, label="retrieved")
    plot.frames(axis, frames)
    plot.legend(figure)
    plot.save(figure, "movement.png")

No window is opened and no global state of Matplotlib is changed. ``import tpsim`` does not load
this package: import it by name.
"""

from tpsim.plot.bodies import arm as arm
from tpsim.plot.bodies import skeleton as skeleton
from tpsim.plot.curves import band as band
from tpsim.plot.curves import matrix as matrix
from tpsim.plot.plane import demonstrations as demonstrations
from tpsim.plot.plane import ellipses as ellipses
from tpsim.plot.plane import frames as frames
from tpsim.plot.plane import points as points
from tpsim.plot.plane import tube as tube
from tpsim.plot.style import INK as INK
from tpsim.plot.style import PALETTE as PALETTE
from tpsim.plot.style import Kind as Kind
from tpsim.plot.style import legend as legend
from tpsim.plot.style import panels as panels
from tpsim.plot.style import same_view as same_view
from tpsim.plot.style import save as save
from tpsim.plot.style import shades as shades
from tpsim.plot.style import title as title
