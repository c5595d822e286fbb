"""Furniture made to measure, as MJCF text for :class:`~tpsim.scene.compose.Placed`."""

from tpsim.border import Positive, border

TOP = 0.04
"""Thickness of a table's top [m]."""


@border
def table(depth: Positive = 0.5, width: Positive = 0.9, height: Positive = 0.66) -> str:
    """A table; its origin, the site ``table``, is the middle of its top.

    Parameters
    ----------
    depth, width, height : float
        Along x, along y, and from the floor to the top [m].
    """
    x, y = depth / 2, width / 2
    legs = "".join(
        f'<geom class="steel" fromto="{a} {b} {-height} {a} {b} {-TOP}"/>'
        for a in (x - 0.04, 0.04 - x)
        for b in (y - 0.04, 0.04 - y)
    )
    top = f'pos="0 0 {-TOP / 2}" size="{x} {y} {TOP / 2}"'
    return f"""
<mujoco model="table">
  <compiler angle="radian" autolimits="true"/>
  <default>
    <default class="wood">
      <geom type="box" material="wood" group="2" mass="0" contype="0" conaffinity="0"/>
    </default>
    <default class="steel">
      <geom type="cylinder" size=".016" material="steel" group="2" mass="0" contype="0"
       conaffinity="0"/>
    </default>
  </default>
  <asset>
    <material name="wood" rgba=".62 .50 .37 1" specular=".15" shininess=".3"/>
    <material name="steel" rgba=".30 .31 .33 1" specular=".4" shininess=".5"/>
  </asset>
  <worldbody>
    <body name="table">
      <site name="table" group="4"/>
      <geom name="table" type="box" group="3" mass="0" {top}/>
      <geom class="wood" {top}/>
      {legs}
    </body>
  </worldbody>
</mujoco>"""


@border
def pedestal(width: Positive, height: Positive) -> str:
    """A box that a robot stands on; its origin is the middle of its top.

    Parameters
    ----------
    width, height : float
        [m]
    """
    shape = f'pos="0 0 {-height / 2}" size="{width / 2} {width / 2} {height / 2}"'
    return f"""
<mujoco model="pedestal">
  <asset><material name="pedestal" rgba=".42 .43 .45 1" specular=".2" shininess=".3"/></asset>
  <worldbody>
    <body name="pedestal">
      <geom type="box" group="2" mass="0" contype="0" conaffinity="0" material="pedestal" {shape}/>
    </body>
  </worldbody>
</mujoco>"""
