"""How far to trust a tree that grew on votes: probabilities that follow what the field told."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from prunus.errors import NoTreeError
from prunus.lab.evaluate.right import right_edges
from prunus.model import Floats, Label, Role, Skeleton, Told
from prunus.model.branches import branches
from prunus.pipeline import skeletonize
from prunus.result import Result
from prunus.trust import Known, Model, Trust, shipped_model, trust_in
from prunus.trust.evidence import of_branches, of_edges, of_tree
from prunus.trust.review import whole_review
from tests.conftest import simulated
from tests.drawn import tree
from tests.growth.drawn import TEXTBOOK, surface_of

FOR = ("least", "mean", "kind", "rival", "wood", "way", "straight", "explained", "edge", "branch",
       "lead", "sure")  # fmt: skip
AGAINST = ("beside", "scatter", "unclear", "astray", "loose", "around")


def known(picture: Skeleton | None = None, **changes: float) -> Known:
    """A drawn tree of which the field told all rightly, but for some numbers of the whole."""
    drawn = tree() if picture is None else picture
    rows = np.arange(len(drawn))
    role = np.full((len(drawn), len(Role)), 0.02)
    role[rows, drawn.label] = 0.90
    skeleton = Skeleton.build(
        drawn.xyz, drawn.parent, drawn.label, confidence=np.where(rows > 0, 0.9, np.nan),
        radius=np.full(len(drawn), 0.01), superpoint=rows,
    )  # fmt: skip
    whole = {"unclear": 0.3, "explained": 0.95, "loose": 0.1, "around": 0.0, "astray": 0.05}
    told = Told(role=role, scatter=np.full(len(drawn), 0.004),
                whole=whole | {"lead": 4.0} | changes)  # fmt: skip
    return Known(skeleton, told)


@pytest.fixture(scope="module")
def textbook() -> Result:
    return skeletonize(surface_of(TEXTBOOK, np.random.default_rng(0)))


def test_the_model_survives_its_file(tmp_path: Path) -> None:
    path = tmp_path / "trust.toml"
    path.write_text(shipped_model().to_toml())
    assert Model.from_toml(path) == shipped_model()


def test_nothing_that_speaks_for_a_tree_lowers_its_trust() -> None:
    model = shipped_model()
    for odds in (*model.parts.branch.values(), model.parts.edge, *model.whole.values()):
        assert all(odds.weight.get(name, 0.0) >= 0 for name in FOR)
        assert all(odds.weight.get(name, 0.0) <= 0 for name in AGAINST)


def test_all_that_the_model_asks_for_is_known() -> None:
    model, told = shipped_model(), known()
    for branch, evidence in zip(branches(told.skeleton), of_branches(told, 1.0), strict=True):
        assert set(model.parts.branch[branch.label].weight) <= set(evidence)
    edges = of_edges(told, np.full(len(branches(told.skeleton)), 0.5), 1.0)
    assert set(model.parts.edge.weight) <= set(edges[0])
    for odds in model.whole.values():
        assert set(odds.weight) <= set(of_tree(told))


def test_every_branch_and_edge_of_a_grown_tree_has_a_probability(textbook: Result) -> None:
    trust = textbook.trust
    assert trust is not None
    assert len(trust.branch) == len(branches(textbook.in_house))
    assert len(trust.edge) == len(textbook.in_house) and np.isnan(trust.edge[0])
    assert ((trust.edge[1:] > 0) & (trust.edge[1:] < 1)).all()
    assert trust.tree == pytest.approx(float(trust.edge[1:].mean()))


def test_a_textbook_tree_is_trusted_and_of_our_kind(textbook: Result) -> None:
    assert textbook.trust is not None
    assert textbook.trust.tree > 0.85
    assert not any("not my kind" in line for line in textbook.review)


def test_what_is_wrong_is_trusted_less() -> None:
    right, wrong = list[float](), list[float]()
    for seed in (2, 4):
        truth, cloud = simulated(seed)
        result = skeletonize(cloud)
        assert result.trust is not None
        fine = right_edges(result.skeleton, truth)
        right += result.trust.edge[1:][fine].tolist()
        wrong += result.trust.edge[1:][~fine].tolist()
    assert np.mean(right) > np.mean(wrong) + 0.02


@pytest.mark.parametrize(
    ("changes", "part"),
    [({"astray": 0.4, "unclear": 1.2}, "wood"), ({"lead": -0.5}, "meant")],
)
def test_a_doubt_in_the_whole_lowers_all(changes: dict[str, float], part: str) -> None:
    fine, less = trust_in(known()), trust_in(known(**changes))
    assert getattr(less, part) < getattr(fine, part)
    assert less.tree < fine.tree
    assert (less.branch < fine.branch).all()


def test_roles_that_are_unclear_are_of_another_form() -> None:
    assert trust_in(known(unclear=1.2)).form < trust_in(known()).form


def test_unsure_labels_lower_the_trust_in_branches() -> None:
    told = known()
    role = np.full_like(told.told.role, 1 / len(Role))
    unsure = Known(told.skeleton, replace(told.told, role=role))
    fine, less = trust_in(told), trust_in(unsure)
    assert less.tree < fine.tree
    assert less.branch.mean() < fine.branch.mean()


def test_a_strand_that_runs_beside_a_leader_is_evidence_against_both() -> None:
    single, double = known(tree("l  b\nl lb\nsst \n  t \n  o ")), known()
    assert all(
        0 <= one["beside"] <= 1 for one in (*of_branches(single, 1.0), *of_branches(double, 1.0))
    )
    xyz = double.skeleton.xyz.copy()
    leader, other = (one for one in branches(double.skeleton, Label.LEADER)[:2])
    count = min(len(leader.rows), len(other.rows)) - 1
    xyz[other.rows[1 : count + 1]] = xyz[leader.rows[1 : count + 1]] + [0.02, 0.0, 0.0]
    beside = Known(replace(double.skeleton, xyz=xyz), double.told)
    number = [one.rows[1] for one in branches(double.skeleton)].index(leader.rows[1])
    assert of_branches(double, 1.0)[number]["beside"] == 0
    assert of_branches(beside, 1.0)[number]["beside"] > 0.5


def test_a_least_confidence_on_the_way_counts_for_all_above() -> None:
    told = known()
    confidence = told.skeleton.confidence.copy()
    confidence[1] = 0.05
    weak = Known(replace(told.skeleton, confidence=confidence), told.told)
    first, *above = of_branches(weak, 1.0)
    assert first["way"] == 0.0
    assert all(one["way"] == pytest.approx(np.log(0.05)) for one in above)


FINE = Trust(edge=np.full(3, 0.9), branch=np.full(2, 0.9), tree=0.9)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"wood": 0.4}, "not my kind of tree: 40% likely a bare fruit tree"),
        ({"form": 0.2}, "not my kind of tree: 20% likely trained as a UFO tree"),
        ({"meant": 0.5}, "another tree in view may be meant"),
    ],
)
def test_what_is_not_our_kind_is_said_in_words(changes: dict[str, float], says: str) -> None:
    assert whole_review(FINE) == []
    (said,) = whole_review(replace(FINE, **changes))
    assert said.startswith(says)


def needles(rng: np.random.Generator) -> Floats:
    """A cone of needles."""
    z = 2.4 * (1 - np.sqrt(rng.uniform(0, 1, 25_000)))
    out, angle = 0.7 * (1 - z / 2.4) * rng.uniform(0.5, 1, 25_000), rng.uniform(0, 6.3, 25_000)
    return np.column_stack([out * np.cos(angle), out * np.sin(angle), z])


def barrel(rng: np.random.Generator) -> Floats:
    """The wall of a barrel."""
    angle, z = rng.uniform(0, 6.3, 20_000), rng.uniform(0, 1.1, 20_000)
    return np.column_stack([0.4 * np.cos(angle), 0.4 * np.sin(angle), z])


def straw(rng: np.random.Generator) -> Floats:
    """Straws that lie any way up."""
    way = rng.normal(size=(900, 1, 3))
    way /= np.linalg.norm(way, axis=2, keepdims=True)
    middle = rng.uniform(-0.6, 0.6, (900, 1, 3)) * [1.0, 0.6, 0.5]
    return np.asarray((middle + way * rng.uniform(-0.15, 0.15, (900, 30, 1))).reshape(-1, 3))


@pytest.mark.slow
@pytest.mark.parametrize("kind", [needles, barrel, straw])
def test_what_is_no_tree_is_refused_or_said(kind: Callable[[np.random.Generator], Floats]) -> None:
    try:
        review = skeletonize(kind(np.random.default_rng(3))).review
    except NoTreeError as error:
        review = [f"not my kind of tree: {error}"]
    assert any("not my kind of tree" in line for line in review)
