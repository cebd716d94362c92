"""What we write, opened by the programs that docs/files.md names, where they are there."""

import io
import json
import os
import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

import networkx as nx
import numpy as np
import pytest
import trimesh

from prunus.io.skeletons.dxf import COLOURS as NUMBERS
from prunus.io.skeletons.dxf import write_dxf
from prunus.io.skeletons.export import COLOURS, write_graphml, write_ply
from prunus.io.skeletons.swc import write_swc
from prunus.model import Label, Skeleton
from prunus.model.branches import branches
from tests.drawn import tree
from tests.io.skeletons.test_skeletons import random_skeleton

FAR = np.array([500_000.25, 4_649_776.125, 100.0])
PLACES = [np.zeros(3), FAR]


@pytest.fixture(params=PLACES, ids=["near", "far"])
def skeleton(request: pytest.FixtureRequest) -> Skeleton:
    drawn = tree()
    radius = np.linspace(0.03, 0.01, len(drawn))
    moved = [drawn.xyz + request.param, drawn.parent, drawn.label]
    return Skeleton.build(*moved, radius=radius, confidence=np.linspace(0, 1, len(drawn)))


def program(*names: str) -> str:
    """Where a program is; the test is skipped where it is not installed."""
    found = next((path for name in names if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip(f"{names[0]} is not installed")
    return found


def said_by(folder: Path, *words: str | Path) -> str:
    """What a program without a window writes to log.txt, else says."""
    quiet = {"QT_QPA_PLATFORM": "offscreen", "HOME": str(folder), "PWD": str(folder)}
    done = subprocess.run(
        [str(word) for word in words],
        cwd=folder, env=os.environ | quiet, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    log = folder / "log.txt"
    return log.read_text() if log.exists() else done.stdout + done.stderr


def edges_of(xyz: Any, edges: Any) -> Counter[tuple[tuple[float, ...], ...]]:
    """Edges by the places of their ends, whichever is first; to a tenth of a millimetre."""
    ends = np.asarray(xyz)[np.asarray(edges)].round(4) + 0.0
    return Counter(tuple(sorted(map(tuple, pair))) for pair in ends.tolist())


def test_trimesh_loads_the_lines(skeleton: Skeleton, tmp_path: Path) -> None:
    write_ply(tmp_path / "s.ply", skeleton)
    path = trimesh.load(tmp_path / "s.ply")
    edges = [pair for line in path.entities for pair in line.nodes.tolist()]
    found = edges_of(path.vertices, edges)
    assert set(found) == set(edges_of(skeleton.xyz, skeleton.edges))


def test_open3d_reads_coloured_lines(skeleton: Skeleton, tmp_path: Path) -> None:
    open3d = pytest.importorskip("open3d", reason="open3d is not installed")
    write_ply(tmp_path / "s.ply", skeleton)
    lines = open3d.io.read_line_set(str(tmp_path / "s.ply"))
    assert edges_of(lines.points, lines.lines) == edges_of(skeleton.xyz, skeleton.edges)
    colours = np.asarray(lines.colors) * 255
    own = [COLOURS[Label(label)] for label in skeleton.label[1:]]
    assert colours == pytest.approx(np.array(own))


def test_blender_imports_the_edges(skeleton: Skeleton, tmp_path: Path) -> None:
    blender = program("blender")
    write_ply(tmp_path / "s.ply", skeleton)
    (tmp_path / "open.py").write_text(
        "import bpy\n"
        "new = hasattr(bpy.ops.wm, 'ply_import') and bpy.app.version >= (3, 6)\n"
        "(bpy.ops.wm.ply_import if new else bpy.ops.import_mesh.ply)(filepath='s.ply')\n"
        "mesh = bpy.context.selected_objects[0].data\n"
        "print('READ', len(mesh.vertices), len(mesh.edges))\n"
    )
    words = [blender, "--background", "--factory-startup", "--python", "open.py"]
    assert f"READ {len(skeleton)} {len(skeleton) - 1}" in said_by(tmp_path, *words)


def test_cloudcompare_opens_a_polyline_a_branch(skeleton: Skeleton, tmp_path: Path) -> None:
    cloudcompare = program("CloudCompare", "cloudcompare", "cloudcompare.CloudCompare")
    write_dxf(tmp_path / "s.dxf", skeleton)
    words = ["-SILENT", "-LOG_FILE", "log.txt", "-O", "-GLOBAL_SHIFT", "AUTO", "s.dxf"]
    said = said_by(tmp_path, cloudcompare, *words)
    found = re.findall(r"Found one cloud with (\d+) points", said)
    assert Counter(map(int, found)) == Counter(len(b.rows) for b in branches(skeleton))


def test_cloudcompare_opens_the_nodes_of_a_ply(skeleton: Skeleton, tmp_path: Path) -> None:
    cloudcompare = program("CloudCompare", "cloudcompare", "cloudcompare.CloudCompare")
    write_ply(tmp_path / "s.ply", skeleton)
    words = ["-SILENT", "-LOG_FILE", "log.txt", "-O", "-GLOBAL_SHIFT", "AUTO", "s.ply"]
    said = said_by(tmp_path, cloudcompare, *words)
    assert f"Found one cloud with {len(skeleton)} points" in said


def test_ezdxf_finds_nothing_to_mend_and_the_labels(skeleton: Skeleton, tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed")
    write_dxf(tmp_path / "s.dxf", skeleton)
    document = ezdxf.readfile(tmp_path / "s.dxf")
    assert not document.audit().errors
    lines = list(document.modelspace().query("POLYLINE"))
    assert [line.dxf.layer for line in lines] == [b.label.word for b in branches(skeleton)]
    assert {line.dxf.color for line in lines} == set(NUMBERS.values())
    for line, branch in zip(lines, branches(skeleton), strict=True):
        assert line.is_3d_polyline and not line.is_closed
        places = np.array([vertex.dxf.location for vertex in line.vertices])
        assert places == pytest.approx(skeleton.xyz[branch.rows], abs=1e-6, rel=0)


def test_navis_reads_the_swc(skeleton: Skeleton, tmp_path: Path) -> None:
    navis = pytest.importorskip("navis", reason="navis is not installed")
    write_swc(tmp_path / "s.swc", skeleton)
    neuron = navis.read_swc(str(tmp_path / "s.swc"))
    assert len(neuron.nodes) == len(skeleton)
    assert set(map(int, neuron.nodes.label)) == {16, 17, 18, 19}


@pytest.mark.parametrize("kind", ["graphml", "gml", "gexf", "node_link"])
@pytest.mark.parametrize("seed", range(4))
def test_every_writer_of_networkx_takes_the_graph(kind: str, seed: int) -> None:
    skeleton = random_skeleton(seed)
    graph = skeleton.to_networkx()
    back = there_and_back(kind, graph)
    assert back.number_of_nodes() == len(skeleton)
    for row in range(len(skeleton)):
        node = back.nodes[str(row)]
        assert [node[axis] for axis in "xyz"] == pytest.approx(skeleton.xyz[row])
        assert node.get("radius", np.nan) == pytest.approx(skeleton.radius[row], nan_ok=True)
        assert node["superpoint"] == skeleton.superpoint[row]
    for above, row in skeleton.edges.tolist():
        edge = back.edges[str(above), str(row)]
        assert edge["label"] == Label(skeleton.label[row]).word
        assert edge["length"] == pytest.approx(skeleton.lengths[row])
        known = edge.get("confidence", np.nan)
        assert known == pytest.approx(skeleton.confidence[row], nan_ok=True)


def there_and_back(kind: str, graph: Any) -> Any:
    held = io.BytesIO()
    if kind == "node_link":
        told = json.dumps(nx.node_link_data(graph, edges="edges"), allow_nan=False)
        back = nx.node_link_graph(json.loads(told), edges="edges")
        return nx.relabel_nodes(back, str)
    getattr(nx, f"write_{kind}")(graph, held)
    held.seek(0)
    return getattr(nx, f"read_{kind}")(held)


def test_graphml_says_the_same_whether_we_write_it_or_networkx(tmp_path: Path) -> None:
    write_graphml(tmp_path / "ours.graphml", tree())
    nx.write_graphml(tree().to_networkx(), tmp_path / "theirs.graphml")
    ours, theirs = (nx.read_graphml(tmp_path / f"{who}.graphml") for who in ("ours", "theirs"))
    assert ours.nodes(data=True) == theirs.nodes(data=True)
    assert sorted(ours.edges(data=True), key=str) == sorted(theirs.edges(data=True), key=str)
