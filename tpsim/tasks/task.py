"""What a task is: a scene, how it is taught, and what the teacher's frames observe."""

from tpsim.control import projection
from tpsim.demonstration import Demonstration
from tpsim.sim.coordinate import Coordinate
from tpsim.sim.robot import Robot
from tpsim.sim.trial import Trial


def demonstration(robot: Robot, trial: Trial, coordinates: tuple[Coordinate, ...], name=""):
    """One taught trial as it is seen from every candidate frame.

    Parameters
    ----------
    robot : Robot
    trial : Trial
        From kinesthetic teaching; ``q (T, n)`` is what counts.
    coordinates : tuple of Coordinate
        The P candidate frames.
    name : str

    Returns
    -------
    Demonstration
        ``data`` is q (T, n) and ``observations`` holds y_j(q), (T, d_j) each.
    """
    q = trial["q"]
    observations, frames = [], []
    for coordinate in coordinates:
        y, J = coordinate.observe(robot, q)
        observations.append(y)
        frames.append(projection.absolute(J, q, y))
    return Demonstration(trial["time"], q, frames, observations, name)
