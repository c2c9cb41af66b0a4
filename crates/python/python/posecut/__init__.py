"""posecut: which landmark edges (loop closures) of a pose graph are wrong?

>>> import posecut
>>> graph = posecut.read("graph.g2o")
>>> judged = graph.verify()
>>> judged.optimize().write("clean.g2o")

A graph never changes: each method returns a new one. Poses are (x, y, theta) or (x, y, z, qx, qy, qz, qw), in metres and radians.
"""

from posecut._graph import Doubt, Graph, options, read
from posecut._posecut import Error, __version__

__all__ = ["Doubt", "Error", "Graph", "__version__", "options", "read"]
