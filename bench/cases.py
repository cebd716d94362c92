"""What is measured. Each case yields rows: name, value, unit."""

from __future__ import annotations

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from bench.graphs import PARAMS, graph_of, row_graph, tree_scan
from prunus.geometry.near import within
from prunus.geometry.neighbours import cover
from prunus.io.clouds.cloud_file import write_cloud
from prunus.lab.evaluate.curves import curve_measures
from prunus.lab.evaluate.found import branch_measures
from prunus.lab.simulate import simulate_scan
from prunus.model import SeededGraph
from prunus.paper.kernels.frames import edge_images
from prunus.paper.networks import NetworkScorer
from prunus.paper.population import search
from prunus.paper.potential import path_priors
from prunus.paper.score import graph_table
from prunus.params import Parameters
from prunus.pipeline import skeletonize

Row = tuple[str, float, str]
RUNS = 7


def cpu(work: Callable[[], object], runs: int = RUNS) -> float:
    """Median CPU seconds of some runs, after one to warm up."""
    work()
    spent = []
    for _ in range(runs):
        start = time.process_time()
        work()
        spent.append(time.process_time() - start)
    return statistics.median(spent)


def kernels() -> Iterator[Row]:
    """Each kernel on the data of one tree of 50 000 points."""
    graph = graph_of(101)
    under = graph.superpoints
    xyz = under.cloud.xyz
    order = np.random.default_rng(0).permutation(len(xyz))
    yield "kernel cover", cpu(lambda: cover(xyz, order, under.radius)), "s"
    yield "kernel within", cpu(lambda: within(xyz, under.xyz, under.radius)), "s"
    ends = (xyz, under.xyz, under.start, under.members, graph.edges, under.radius)
    yield "kernel edge_images", cpu(lambda: edge_images(*ends)), "s"
    table, score, cost = graph_table(graph, PARAMS, np.random.default_rng(0))
    yield (
        "kernel turn_penalties",
        cpu(lambda: graph_table(graph, PARAMS, np.random.default_rng(0))),
        "s",
    )
    paths = cpu(lambda: path_priors(table, score, cost, graph.base, graph.tips))
    yield "kernel tip_paths", paths, "s"


def searches() -> Iterator[Row]:
    """The search on connected graphs with two edges a superpoint; growth with both sizes."""
    target = row_graph(250)
    size = f"N=250 E={len(target.edges)} T={len(target.tips)}"
    yield from _search_rows(f"search K=500 {size}", target, PARAMS)
    for nodes in (125, 500, 1000, 2000):
        graph = row_graph(nodes)
        yield from _search_rows(f"search K=500 N={nodes} T={len(graph.tips)}", graph, PARAMS)
    for K in (100, 1000, 2500, 5000, 10_000):
        params = PARAMS.changed("search", K=K)
        yield from _search_rows(f"search K={K} N=250", target, params)


def _search_rows(name: str, graph: SeededGraph, params: Parameters) -> Iterator[Row]:
    """Median over seeds; and that of an iteration, since seeds differ in how many they take."""
    search(graph, params, np.random.default_rng(0))
    spent, each = [], []
    for seed in range(RUNS):
        start = time.process_time()
        found = search(graph, params, np.random.default_rng(seed))
        spent.append(time.process_time() - start)
        each.append(1000 * spent[-1] / len(found.history))
    yield name, statistics.median(spent), "s"
    yield f"{name}, an iteration", statistics.median(each), "ms"


def chain() -> Iterator[Row]:
    """From points in memory to a skeleton, and from a PLY file to all outputs but the report."""
    for points in (20_000, 50_000, 300_000, 3_000_000):
        truth, xyz = tree_scan(101, points)
        spent = cpu(partial(skeletonize, xyz, truth.xyz[0]), 5)
        yield f"chain {points:,} points", spent, "s"
    for points in (50_000, 300_000, 3_000_000):
        yield from _file(points)


def _file(points: int) -> Iterator[Row]:
    """A file read, skeletonized and written in a process of its own, which measures itself."""
    truth, xyz = tree_scan(101, points)
    code = (
        "import sys, json\n"
        "from pathlib import Path\n"
        "from prunus.batch.run import Options, Task, do\n"
        "path, base = Path(sys.argv[1]), tuple(json.loads(sys.argv[2]))\n"
        "task = Task(path, path.parent / 'out')\n"
        "options = Options(base, 'z-up', report=False)\n"
        "spent = [do(task, options)['cpu_s']['total'] for _ in range(4)]\n"
        "status = Path('/proc/self/status').read_text()\n"
        "peak = int(status.split('VmHWM:')[1].split()[0]) / 1024\n"
        "print(json.dumps([sorted(spent[1:])[1], peak]))"
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tree.ply"
        write_cloud(path, xyz)
        base = json.dumps(truth.xyz[0].tolist())
        done = subprocess.run(
            [sys.executable, "-c", code, path, base], capture_output=True, text=True, check=True
        )
        spent, peak = json.loads(done.stdout)
    yield f"file to skeleton.json, {points:,} points", spent, "s"
    yield f"peak memory, {points:,} points", peak, "MB"


def cold() -> Iterator[Row]:
    """The command line from a cold start, and the very first run, which compiles."""
    program = Path(sys.executable).parent / "prunus"
    yield "prunus --help", _child([program, "--help"]), "s"
    truth, xyz = tree_scan(101)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tree.ply"
        write_cloud(path, xyz)
        base = [str(value) for value in truth.xyz[0].tolist()]
        words = [program, "skeletonize", path, "-o", Path(folder) / "out", "--base", *base]
        _child(words)
        yield "prunus skeletonize, kernels cached", _child(words), "s"
        empty = os.environ | {"PRUNUS_CACHE_DIR": str(Path(folder) / "cache")}
        yield "prunus skeletonize, the very first run", _child(words, empty, 1), "s"


def _child(words: list[object], environment: dict[str, str] | None = None, runs: int = 5) -> float:
    spent = []
    for _ in range(runs):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [str(word) for word in words], env=environment, capture_output=True, check=True
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return statistics.median(spent)


def quality() -> Iterator[Row]:
    """Mean score of five seeds at K = 500 against K = 5000."""
    ratios = []
    for seed in range(100, 106):
        means = []
        for K in (500, 5000):
            params = PARAMS.changed("search", K=K)
            scores = [
                search(graph_of(seed), params, np.random.default_rng(s)).score for s in range(5)
            ]
            means.append(statistics.mean(scores))
        ratios.append(means[0] / means[1])
        yield f"score K=500 / K=5000, tree {seed}", ratios[-1], "ratio"
    yield "score K=500 / K=5000, mean", statistics.mean(ratios), "ratio"


def optimum() -> Iterator[Row]:
    """Share of the exhaustive optimum on 30 random graphs: 8 nodes, 11 edges, 7 tips."""
    from tests.paper.graphs import orchard, random_graph

    graphs = [random_graph(seed, nodes=8, edges=11, tips=7) for seed in range(30)]
    best = [orchard(graph, PARAMS).best()[1] for graph in graphs]
    for K in (500, 5000):
        params = PARAMS.changed("search", K=K)
        shares = [
            search(graph, params, np.random.default_rng(0)).score / top
            for graph, top in zip(graphs, best, strict=True)
            if top > 0
        ]
        yield f"optimum reached, K={K}, mean", statistics.mean(shares), "ratio"
        yield f"optimum reached, K={K}, worst", min(shares), "ratio"


def scores() -> Iterator[Row]:
    """Curve measures of the paper's method on twenty field scans, the target alone and the row."""
    for what in ("target", "row"):
        found = [_measured(seed, what) for seed in range(300, 320)]
        for measure in found[0]:
            values = [measures[measure] for measures in found]
            yield f"{what}: {measure}", float(np.nanmean(values)), "ratio"


def _measured(seed: int, what: str) -> dict[str, float]:
    scan = simulate_scan(seed)
    cloud = scan.target_cloud() if what == "target" else scan.cloud()
    result = skeletonize(cloud, scan.truth.xyz[0], PARAMS)
    found = curve_measures(result.skeleton, scan.truth)
    return found | branch_measures(result.skeleton, scan.truth)


def network() -> Iterator[Row]:
    """CPU seconds of the scorer, images included, on the edges of one tree."""
    candidates = graph_of(101).scored.candidates
    scorer = NetworkScorer()
    yield f"scorer, E={len(candidates.edges)}", cpu(lambda: scorer(candidates)), "s"


CASES: dict[str, Callable[[], Iterator[Row]]] = {
    "kernels": kernels,
    "search": searches,
    "chain": chain,
    "cold": cold,
    "quality": quality,
    "optimum": optimum,
    "network": network,
    "scores": scores,
}
