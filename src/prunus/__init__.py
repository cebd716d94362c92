"""From a 3D point cloud of a dormant fruit tree to a labelled skeleton.

    import prunus
    result = prunus.skeletonize(prunus.read_cloud("tree.ply"))
    result.skeleton.to_networkx()

Names are loaded when they are first used, so that `import prunus` is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from prunus.errors import PrunusError as PrunusError
    from prunus.frames.scan import read_cloud as read_cloud
    from prunus.io.skeletons.skeleton_file import read_skeleton as read_skeleton
    from prunus.io.skeletons.skeleton_file import write_skeleton as write_skeleton
    from prunus.method import Method as Method
    from prunus.model import Label as Label
    from prunus.model import PointCloud as PointCloud
    from prunus.model import Skeleton as Skeleton
    from prunus.paper.confidence import EdgeScorer as EdgeScorer
    from prunus.paper.graphs import GraphSkeleton as GraphSkeleton
    from prunus.paper.graphs import search_graph as search_graph
    from prunus.params import Parameters as Parameters
    from prunus.pipeline import skeletonize as skeletonize
    from prunus.result import Result as Result
    from prunus.schemas import schema as schema

__version__ = "0.2.0"

_HOME = {
    "EdgeScorer": "prunus.paper.confidence",
    "GraphSkeleton": "prunus.paper.graphs",
    "Label": "prunus.model",
    "Method": "prunus.method",
    "Parameters": "prunus.params",
    "PointCloud": "prunus.model",
    "PrunusError": "prunus.errors",
    "Result": "prunus.result",
    "Skeleton": "prunus.model",
    "read_cloud": "prunus.frames.scan",
    "read_skeleton": "prunus.io.skeletons.skeleton_file",
    "schema": "prunus.schemas",
    "search_graph": "prunus.paper.graphs",
    "skeletonize": "prunus.pipeline",
    "write_skeleton": "prunus.io.skeletons.skeleton_file",
}

__all__ = [*sorted(_HOME)]  # noqa: PLE0604, the names are strings


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'prunus' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
