"""Laws of correction: after every act the tree is legal, or the act is refused and nothing is."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from prunus.editing import (
    Act,
    AddPath,
    MoveBase,
    Reattach,
    Refused,
    Relabel,
    RemoveBranch,
    RemoveEdge,
    Together,
    branch_names,
)
from prunus.editing.edits import edits
from prunus.editing.state import State, apply, clear
from prunus.editing.words import OTHERS, RULES
from prunus.errors import PrunusError
from prunus.model import Label
from prunus.model.branches import branches
from prunus.model.leaders import leaders
from prunus.rules import RULES as PREDICATES
from prunus.rules import offenders
from tests.drawn import TREE
from tests.editing.trees import node, outside, random_act, spare, state

FORKED = """
     bb
l   lb  l
l   l   l
ssstsssss
   t
   o
"""
LONG = """
l   l
l   l  l
ssstssss
   t
   t
   o
"""
"""A leader in the middle of the right support, one at its end."""
PICTURES = [TREE, FORKED, LONG, "l\nl\nt\no", "o"]


def tried(at: State, act: Act) -> State | Refused | None:
    """What comes of an act; None where it names what is not there."""
    try:
        return apply(at, act)
    except Refused as refused:
        return refused
    except PrunusError:
        return None


def refusal(at: State, act: Act) -> Refused:
    with pytest.raises(Refused) as raised:
        apply(at, act)
    return raised.value


@settings(max_examples=40, deadline=None)
@given(some.sampled_from(PICTURES), some.integers(0, 2**32))
def test_whatever_is_done_the_tree_stays_legal(picture: str, seed: int) -> None:
    at, rng = state(picture), np.random.default_rng(seed)
    for _ in range(12):
        came = tried(at, random_act(at, rng))
        if isinstance(came, Refused):
            assert came.rule in {*RULES, *OTHERS}
            assert np.isfinite(came.places).all()
            offers = [act for _, act in came.repairs]
            came = apply(at, offers[int(rng.integers(len(offers)))]) if offers else None
        if came is not None:
            at = came
        skeleton = at.draft.skeleton()
        assert offenders(skeleton) == {}
        assert len(set(at.draft.nodes)) == len(at.draft.nodes) == len(at.draft.into) + 1


@settings(max_examples=40, deadline=None)
@given(some.integers(0, 2**32))
def test_every_repair_that_is_offered_can_be_done(seed: int) -> None:
    at, rng = state(), np.random.default_rng(seed)
    for _ in range(10):
        came = tried(at, random_act(at, rng))
        if isinstance(came, Refused):
            for words, act in came.repairs:
                assert words
                assert offenders(apply(at, act).draft.skeleton()) == {}
        elif came is not None:
            at = came


@settings(max_examples=40, deadline=None)
@given(some.integers(0, 2**32))
def test_an_act_with_its_route_named_does_the_same(seed: int) -> None:
    at, rng = state(), np.random.default_rng(seed)
    for _ in range(8):
        act = random_act(at, rng)
        came = tried(at, act)
        if isinstance(came, State):
            named = clear(at, act)
            assert "routed=True" not in repr(named)
            assert apply(at, named).draft.into == came.draft.into
            at = came


def test_before_any_act_the_draft_is_what_the_machine_found() -> None:
    at = state()
    ours, theirs = at.draft.skeleton(), at.result.in_house
    for name in ("xyz", "label", "superpoint"):
        assert np.array_equal(getattr(ours, name)[np.argsort(ours.superpoint)],
                              getattr(theirs, name))  # fmt: skip
    assert edits(theirs, at.draft.numbered()).ratio == 0


def test_the_rules_are_all_in_words() -> None:
    assert {rule.__name__ for rule in PREDICATES} == set(RULES)


def test_branches_are_those_of_the_measures() -> None:
    draft = state(FORKED).draft
    found = {tuple(draft.branch(one)) for one in draft.into}
    rows = [tuple(draft.nodes[r] for r in b.rows[1:]) for b in branches(draft.skeleton())]
    assert found == set(rows)


def test_leaders_are_numbered_as_the_report_numbers_them() -> None:
    draft = state(FORKED).draft
    names = branch_names(draft)
    tops = [draft.nodes[leader.row] for leader in leaders(draft.skeleton())]
    assert [names[top] for top in tops] == ["leader 1", "leader 2", "leader 3"]


def test_an_edge_goes_with_what_hangs_beyond_it() -> None:
    at = state()
    foot = node(at, 4, 3)
    after = apply(at, RemoveEdge(foot))
    assert set(at.draft.into) - set(after.draft.into) == set(at.draft.beyond(foot))
    assert len(at.draft.beyond(foot)) == 4, "three of the leader, one side branch"


def test_a_leader_takes_its_side_branches_with_it() -> None:
    at = state()
    top = node(at, 4, 5)
    after = apply(at, RemoveBranch(top))
    names = branch_names(at.draft)
    gone = {names[n] for n in at.draft.into if n not in after.draft}
    assert gone == {"leader 2", "side branch 1"}


@pytest.mark.parametrize("act", [RemoveEdge, RemoveBranch])
def test_the_first_edge_of_the_trunk_stays(act: type) -> None:
    at = state()
    first = node(at, 3, 1)
    said = refusal(at, act(first))
    assert said.rule == "keeps_its_trunk"
    assert said.nodes == [first]
    assert "the whole tree hangs on this edge" in str(said)


def test_a_leader_drawn_from_a_leader_becomes_its_side_branch() -> None:
    at = state()
    middle = node(at, 0, 4)
    said = refusal(at, AddPath((middle, spare(at, middle)), Label.LEADER))
    assert said.rule == "label_linearity"
    assert said.nodes == [middle]
    words, act = said.repairs[0]
    assert words == "becomes a side branch of leader 1"
    after = apply(at, act)
    assert after.draft.into[spare(at, middle)] == (middle, Label.SIDE_BRANCH)


def test_a_third_support_is_refused() -> None:
    at = state()
    top = node(at, 3, 2)
    said = refusal(at, AddPath((top, spare(at, top)), Label.SUPPORT))
    assert said.rule == "trunk_support_split"
    offered = [words for words, _ in said.repairs]
    assert offered[0] == "becomes a leader of the trunk"
    assert "as asked, without support 1 and leader 1" in offered


def test_where_a_support_leaves_the_trunk_ends() -> None:
    at = state(LONG)
    middle = node(at, 3, 1)
    said = refusal(at, AddPath((middle, spare(at, middle)), Label.SUPPORT))
    assert said.rule == "trunk_support_split"
    assert said.nodes == [middle]


def test_a_path_goes_on_where_a_branch_ends() -> None:
    at = state()
    top = node(at, 0, 5)
    after = apply(at, AddPath((top, spare(at, top)), Label.LEADER))
    assert after.draft.branch(top)[-1] == spare(at, top)
    assert len(leaders(after.draft.skeleton())) == 3


def test_free_points_stand_where_they_were_put_and_have_numbers_of_their_own() -> None:
    at = state()
    top = node(at, 0, 5)
    place = at.draft.places[top] + [0.03, 0.01, 0.12]
    count = len(at.draft.places)
    after = apply(at, AddPath((top, outside(at, place)), Label.LEADER))
    assert after.draft.places[count] == pytest.approx(place, abs=1e-6)
    assert after.draft.skeleton().superpoint[after.draft.nodes.index(count)] == -1
    assert after.draft.numbered().superpoint[after.draft.nodes.index(count)] == count
    again = apply(apply(after, RemoveEdge(count)), AddPath((top, count), Label.LEADER))
    assert again.draft.into == after.draft.into


@pytest.mark.parametrize(
    ("stops", "rule"),
    [
        (lambda at: (spare(at, 3), spare(at, 4)), "stays_a_tree"),
        (lambda at: (node(at, 0, 5), node(at, 7, 5)), "stays_a_tree"),
        (lambda at: (node(at, 0, 5), spare(at, 3), spare(at, 3)), "stays_a_tree"),
        (lambda at: (node(at, 0, 5), outside(at, at.draft.places[node(at, 0, 5)])), "stays_a_tree"),
        (lambda at: (node(at, 0, 5), (0.0, 0.0, 0.0)), "near_the_scan"),
    ],
)
def test_a_path_leads_from_the_tree_to_new_places(stops: object, rule: str) -> None:
    at = state()
    assert refusal(at, AddPath(stops(at), Label.LEADER)).rule == rule


def test_a_path_drawn_towards_the_tree_is_offered_from_its_other_end() -> None:
    at = state()
    top = node(at, 0, 5)
    said = refusal(at, AddPath((spare(at, top), top), Label.LEADER))
    assert said.repairs == [
        ("is drawn from its other end", AddPath((top, spare(at, top)), Label.LEADER))
    ]


def test_two_nodes_of_the_tree_joined_mean_that_one_hangs_on_the_other() -> None:
    at = state()
    shoot, other = node(at, 5, 4), node(at, 4, 3)
    said = refusal(at, AddPath((other, shoot), Label.SIDE_BRANCH))
    assert said.repairs[0] == ("side branch 1 is hung here instead", Reattach(shoot, other))


@pytest.mark.parametrize(("reach", "edges"), [("edge", 1), ("onward", 2), ("branch", 3)])
def test_a_relabelling_reaches_as_far_as_it_says(reach: str, edges: int) -> None:
    at = state()
    middle = node(at, 0, 4)
    wrong = Relabel(middle, Label.SIDE_BRANCH, reach)
    came = tried(at, wrong)
    if reach == "onward":
        assert isinstance(came, State)
        changed = [n for n in at.draft.into if at.draft.into[n] != came.draft.into[n]]
        assert len(changed) == edges
    else:
        assert isinstance(came, Refused), "a side branch leaves a leader, and stays one"
        assert "leader 1 becomes a side branch from here on" in [words for words, _ in came.repairs]


@pytest.mark.parametrize("picture", PICTURES)
def test_until_a_node_and_onward_from_it_meet_in_that_node_alone(picture: str) -> None:
    draft = state(picture).draft
    for one in draft.into:
        assert draft.until(one) + draft.onward(one)[1:] == draft.branch(one)


def test_a_relabelling_until_a_node_leaves_what_lies_beyond_it() -> None:
    at = state()
    middle = node(at, 0, 4)
    told = apply(at, Relabel(middle, Label.SUPPORT, "until")).draft
    assert {told.into[n][1] for n in at.draft.until(middle)} == {Label.SUPPORT}
    assert {told.into[n][1] for n in at.draft.onward(middle)[1:]} == {Label.LEADER}


def test_a_support_that_becomes_a_leader_takes_what_hangs_on_it_along() -> None:
    at = state(LONG)
    said = refusal(at, Relabel(node(at, 5, 3), Label.LEADER, "branch"))
    assert said.nodes == [node(at, 4, 3)]
    assert "as asked, leader 2 becomes a side branch" in [words for words, _ in said.repairs]


def test_no_loop_is_hung() -> None:
    at = state()
    said = refusal(at, Reattach(node(at, 0, 3), node(at, 0, 5)))
    assert said.rule == "stays_a_tree"
    assert "no loops" in str(said)


def test_the_base_moves_up_the_trunk() -> None:
    at = state()
    up = node(at, 3, 1)
    after = apply(at, MoveBase(up))
    assert after.draft.base == up
    assert after.base == pytest.approx(at.draft.places[up])
    assert set(at.draft.nodes) - set(after.draft.nodes) == {at.draft.base}


def test_the_base_moves_down_and_the_trunk_is_led_to_it() -> None:
    at = state()
    lower = at.draft.places[0] - [0, 0, 0.15]
    after = apply(at, MoveBase(outside(at, lower)))
    assert after.draft.into[0] == (after.draft.base, Label.TRUNK)
    assert after.draft.places[after.draft.base] == pytest.approx(lower, abs=1e-6)
    assert after.draft.skeleton().superpoint[0] == -1


def test_a_base_beside_the_trunk_cuts_what_is_below() -> None:
    at = state()
    after = apply(at, MoveBase(spare(at, node(at, 3, 1))))
    assert after.draft.base == spare(at, node(at, 3, 1))
    assert 0 not in after.draft
    assert offenders(after.draft.skeleton()) == {}


def test_the_base_is_no_place_on_a_leader() -> None:
    at = state()
    assert refusal(at, MoveBase(node(at, 0, 4))).rule == "one_trunk_at_base"


@pytest.mark.parametrize(
    "act",
    [
        RemoveEdge(999),
        RemoveEdge(0),
        Relabel(30, Label.LEADER),
        Reattach(0, 1),
        AddPath((0, 999), Label.TRUNK),
        MoveBase(999),
    ],
)
def test_nodes_that_are_not_there_are_told(act: Act) -> None:
    with pytest.raises(PrunusError, match=r"node \d+"):
        apply(state(), act)


def test_acts_together_need_be_legal_only_at_their_end() -> None:
    at = state(LONG)
    first = Relabel(node(at, 5, 3), Label.LEADER, "branch")
    refusal(at, first)
    both = Together((first, Relabel(node(at, 4, 4), Label.SIDE_BRANCH, "onward")))
    assert offenders(apply(at, both).draft.skeleton()) == {}


def test_the_state_before_stays_as_it_was() -> None:
    at = state()
    before = dict(at.draft.into)
    apply(at, RemoveBranch(node(at, 4, 5)))
    assert at.draft.into == before
