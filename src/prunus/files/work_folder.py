"""The names of files in a folder of outputs, of simulated scans, or of work in the studio."""

SKELETON, REFINED, TRUTH = "skeleton.json", "refined.json", "truth.json"
CORRECTED = "corrected.json"
PLAN, REPORT, PARAMS = "plan.json", "report.html", "params.toml"
SCAN, TREES, MASK = "scan.ply", "trees.npz", "mask.ply"
JOURNAL, LABELS, GRAPH = "journal.jsonl", "labels.jsonl", "graph.npz"
