"""Tubes around branches, and the glTF and OBJ made of them, opened with trimesh."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from prunus.frames.orient import UPWARD
from prunus.io.meshes.gltf import write_gltf
from prunus.io.meshes.mesh import SIDES, frames_along, tube_around, tubes
from prunus.io.meshes.obj import write_obj
from prunus.model import FRAMES, Label, RigidMotion, Skeleton
from tests.drawn import tree

THICK = 0.01


def thick(picture: str | None = None) -> Skeleton:
    drawn = tree() if picture is None else tree(picture)
    return drawn.with_radius(np.full(len(drawn), THICK))


def wander(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.asarray(np.cumsum(rng.normal(size=(int(rng.integers(2, 30)), 3)), axis=0))


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_every_tube_is_closed_and_its_faces_look_outward(seed: int) -> None:
    line = wander(seed)
    vertices, normals, faces = tube_around(line, np.full(len(line), 1e-3))
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1)


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000))
def test_frames_are_carried_along_without_twist(seed: int) -> None:
    tangents, sides, ups = frames_along(wander(seed))
    for i in range(1, len(tangents)):
        axes = np.stack([tangents[i], sides[i], ups[i]])
        assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-9)
        least = np.cross(tangents[i - 1], tangents[i])
        moved = sides[i] - sides[i - 1]
        turned_only_about_it = np.dot(moved, least) / max(np.linalg.norm(least), 1e-9)
        assert turned_only_about_it == pytest.approx(0, abs=1e-6)


def test_a_straight_tube_has_the_volume_of_its_prism() -> None:
    mesh = trimesh.Trimesh(*tube_around(np.array([[0, 0, 0], [0, 0, 1], [0, 0, 3.0]]),
                                        np.full(3, 0.1))[::2], process=False)  # fmt: skip
    ring = SIDES / 2 * np.sin(2 * np.pi / SIDES) * 0.1**2
    assert mesh.volume == pytest.approx(3 * ring)


def test_a_line_that_turns_straight_back_is_still_a_tube() -> None:
    line = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 0], [0, 0, 1.0]])
    vertices, normals, _ = tube_around(line, np.full(4, 0.1))
    assert np.isfinite(vertices).all()
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1)


def test_a_branch_starts_as_thick_as_its_own_first_node() -> None:
    skeleton = tree("t\nts\no")
    radius = np.where(skeleton.label == Label.SUPPORT, 0.01, 0.03)
    trunk, support = tubes(skeleton.with_radius(radius))
    assert [trunk.name, support.name] == ["the trunk", "support 1"]
    assert np.ptp(support.vertices[:, 2]) == pytest.approx(0.02)
    assert np.ptp(trunk.vertices[:, 1]) == pytest.approx(0.06)


def test_nodes_in_one_place_make_no_ring_and_a_branch_without_length_no_tube() -> None:
    xyz = [(0, 0, 0), (0, 0, 1), (0, 0, 1), (0, 0, 2), (0, 0, 2)]
    labels = [Label.TRUNK] * 4 + [Label.SUPPORT]
    made = tubes(Skeleton.build(xyz, [-1, 0, 1, 2, 3], labels, radius=np.full(5, THICK)))
    assert [tube.name for tube in made] == ["the trunk"]
    assert len(made[0].vertices) == 3 * SIDES + 2


@pytest.mark.parametrize("ending", [".glb", ".gltf"])
@pytest.mark.parametrize("frame", UPWARD.values())
def test_gltf_opens_upright_with_a_mesh_a_branch(tmp_path: Path, ending: str, frame: str) -> None:
    far = np.array([4e5, 5e6, 100.0])
    skeleton = thick()
    to_file = RigidMotion(FRAMES[frame].T, far)
    write_gltf(tmp_path / f"t{ending}", skeleton.moved(to_file))
    scene = trimesh.load(tmp_path / f"t{ending}")
    assert set(scene.geometry) == {tube.name for tube in tubes(skeleton)}
    x, y, z = skeleton.xyz.T
    seen = np.column_stack([x, z, -y]) + FRAMES[frame].dot(far)[[0, 2, 1]] * (1, 1, -1)
    assert scene.bounds[0] == pytest.approx(seen.min(axis=0) - THICK, abs=2 * THICK)
    assert scene.bounds[1] == pytest.approx(seen.max(axis=0) + THICK, abs=2 * THICK)
    leader = scene.geometry["leader 1"].visual.material
    assert leader.name == "leader"
    assert leader.baseColorFactor[2] > leader.baseColorFactor[0]


def test_obj_opens_with_a_material_a_label(tmp_path: Path) -> None:
    write_obj(tmp_path / "a tree.obj", thick())
    scene = trimesh.load(tmp_path / "a tree.obj")
    assert set(scene.geometry) == {label.word for label in Label}
    whole = trimesh.util.concatenate([tube_mesh(tube) for tube in tubes(thick())])
    assert scene.bounds == pytest.approx(whole.bounds, abs=1e-6)
    assert sum(len(mesh.faces) for mesh in scene.geometry.values()) == len(whole.faces)
    assert scene.geometry["leader"].visual.material.diffuse[:3].tolist() == [0, 114, 178]


def tube_mesh(tube: object) -> trimesh.Trimesh:
    return trimesh.Trimesh(tube.vertices, tube.faces, process=False)
