"""The public names: each is loaded when it is first asked for."""

from .errors import PrunusError as PrunusError
from .frames.scan import read_cloud as read_cloud
from .io.skeletons.skeleton_file import read_skeleton as read_skeleton
from .io.skeletons.skeleton_file import write_skeleton as write_skeleton
from .method import Method as Method
from .model import Label as Label
from .model import PointCloud as PointCloud
from .model import Skeleton as Skeleton
from .paper.confidence import EdgeScorer as EdgeScorer
from .paper.graphs import GraphSkeleton as GraphSkeleton
from .paper.graphs import search_graph as search_graph
from .params import Parameters as Parameters
from .pipeline import skeletonize as skeletonize
from .result import Result as Result
from .schemas import schema as schema

__version__: str
