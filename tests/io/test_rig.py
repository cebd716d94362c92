"""A rig's folder: what is read, and what is said of a bad one."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import write_cloud
from prunus.io.rig import read_rig
from prunus.lab.simulate.orchard import write_simulated
from prunus.model import CloudView, DepthView
from tests.conftest import field_scan

TURN = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]


def record(**changes: Any) -> dict[str, Any]:
    """One view of a tiny depth image; None takes a field away."""
    view: dict[str, Any] = {
        "depth": "d.npy", "depth_unit": 0.001, "width": 3, "height": 2,
        "fx": 2.0, "fy": 2.0, "cx": 1.5, "cy": 1.0, "rotation": TURN, "translation": [1, 2, 3],
    }  # fmt: skip
    return {name: value for name, value in (view | changes).items() if value is not None}


def write(folder: Path, *views: dict[str, Any], **changes: Any) -> Path:
    rig = {"format": "prunus-rig", "version": 1, "unit": "m", "views": views or [record()]}
    (folder / "rig.json").write_text(json.dumps(rig | changes))
    np.save(folder / "d.npy", np.array([[0, 1000, 2000], [3000, 0, 65535]], np.uint16))
    return folder


def test_a_depth_image_is_read_in_metres_with_its_pose(tmp_path: Path) -> None:
    (view,) = read_rig(write(tmp_path))
    assert isinstance(view, DepthView)
    assert view.depth.tolist() == [[0, 1.0, 2.0], [3.0, 0, 65.535]]
    assert view.nominal.rotation == pytest.approx(np.array(TURN))
    assert view.nominal.translation.tolist() == [1, 2, 3]


def test_what_the_simulator_writes_comes_back(tmp_path: Path) -> None:
    scan = field_scan(4)
    write_simulated(tmp_path, scan, views=True)
    views = read_rig(tmp_path)
    assert len(views) == len(scan.views) == 6
    for view, true in zip(views, scan.views, strict=True):
        assert isinstance(view, DepthView)
        assert np.abs(view.depth - true.depth).max() < 0.00051
        assert view.nominal.rotation == pytest.approx(true.nominal.rotation)
        assert view.camera.fx == scan.focal


def test_png_holds_the_same_as_npy(tmp_path: Path) -> None:
    images = pytest.importorskip("PIL.Image")
    write(tmp_path, record(depth="d.png", colour="c.png", mask="m.png"))
    steps = np.load(tmp_path / "d.npy")
    images.fromarray(steps).save(tmp_path / "d.png")
    colour = np.arange(18, dtype=np.uint8).reshape(2, 3, 3)
    images.fromarray(colour).save(tmp_path / "c.png")
    images.fromarray(np.array([[0, 255, 0], [1, 0, 0]], np.uint8)).save(tmp_path / "m.png")
    (view,) = read_rig(tmp_path)
    assert isinstance(view, DepthView)
    assert view.depth == pytest.approx(steps * 0.001)
    assert view.rgb is not None and (view.rgb == colour).all()
    assert view.mask is not None and view.mask.tolist() == [[0, 1, 0], [1, 0, 0]]


def test_an_image_of_eight_bits_is_no_depth_image(tmp_path: Path) -> None:
    images = pytest.importorskip("PIL.Image")
    write(tmp_path, record(depth="d.png"))
    images.fromarray(np.ones((2, 3), np.uint8)).save(tmp_path / "d.png")
    with pytest.raises(PrunusError, match=r"d\.png: holds uint8.*expected a grey image of 16-bit"):
        read_rig(tmp_path)


def test_without_pillow_a_png_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, record(depth="d.png"))
    (tmp_path / "d.png").write_bytes(b"x")
    monkeypatch.setitem(__import__("sys").modules, "PIL", None)
    with pytest.raises(PrunusError, match=r"d\.png: .*need Pillow.*prunus\[fuse\]"):
        read_rig(tmp_path)


def test_partial_clouds_alone_lie_where_they_are(tmp_path: Path) -> None:
    xyz = np.arange(9.0).reshape(3, 3)
    for name in ("top_cloud", "bottom_cloud", "cloud_final"):
        write_cloud(tmp_path / f"{name}.ply", xyz, np.full((3, 3), 7, np.uint8))
    views = read_rig(tmp_path)
    assert [view.name for view in views] == ["bottom_cloud.ply", "top_cloud.ply"]
    for view in views:
        assert isinstance(view, CloudView) and view.rgb is not None
        assert view.nominal.apply(view.xyz) == pytest.approx(xyz)


def test_what_a_mac_leaves_beside_the_files_is_no_view(tmp_path: Path) -> None:
    write_cloud(tmp_path / "top_cloud.ply", np.eye(3))
    (tmp_path / "._top_cloud.ply").write_bytes(b"\0\5\x16\7")
    assert [view.name for view in read_rig(tmp_path)] == ["top_cloud.ply"]


def npy_of(shape: str, body: bytes) -> bytes:
    head = f"{{'descr': '<u2', 'fortran_order': False, 'shape': {shape}}}\n".encode()
    return b"\x93NUMPY\1\0" + len(head).to_bytes(2, "little") + head + body


@pytest.mark.parametrize(
    "content",
    [
        npy_of("(200000, 3000000)", bytes(12)),
        npy_of("(2, 3)", bytes(11)),
        npy_of("(2, 3", bytes(12)),
        b"\x89PNG\r\n\x1a\n" + bytes(20),
        b"P5 900000 900000 65535\n",
    ],
)
@pytest.mark.parametrize("name", ["d.npy", "d.png"])
def test_a_damaged_image_is_one_line(tmp_path: Path, name: str, content: bytes) -> None:
    pytest.importorskip("PIL.Image")
    write(tmp_path, record(depth=name))
    (tmp_path / name).write_bytes(content)
    with pytest.raises(PrunusError, match=rf"{name[0]}\{name[1:]}: .") as error:
        read_rig(tmp_path)
    assert "\n" not in str(error.value)


def test_a_view_may_be_a_partial_cloud(tmp_path: Path) -> None:
    write_cloud(tmp_path / "part.ply", np.eye(3))
    write(tmp_path, record(cloud="part.ply", depth=None))
    (view,) = read_rig(tmp_path)
    assert isinstance(view, CloudView)
    assert view.nominal.apply([1.0, 0, 0]) == pytest.approx([1, 3, 3])


SKEW = [[1, 0, 0], [0, 1, 0.1], [0, 0, 1]]
MIRROR = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]


@pytest.mark.parametrize(
    ("view", "said"),
    [
        (record(fx=None), "views.0.fx: missing"),
        (record(fx=0), "views.0.fx: .*greater than 0"),
        (record(cy=float("nan")), "rig.json: "),
        (record(rotation=SKEW), "views.0.rotation: .*expected a rotation"),
        (record(rotation=MIRROR), "determinant is -1"),
        (record(translation=[0, 0]), "views.0.translation"),
        (record(depth=None), "neither of depth and cloud"),
        (record(cloud="c.ply"), "both of depth and cloud"),
        (record(depth="no.npy"), "no.npy: cannot be read"),
        (record(width=4), "d.npy: the image is 2 rows x 3 columns; expected 2 rows x 4 columns"),
        (record(depths="d.npy"), "views.0.depths: unknown field; expected one of cloud, colour"),
        (record(mask="wide.npy"), "wide.npy: holds bool of the shape .*expected an image of"),
        (record(colour="wide.npy"), "wide.npy: .*expected bytes of the shape"),
        (record(depth="float.npy"), "float.npy: holds float64 .*expected a grey image of 16-bit"),
        (record(depth="text.npy"), "text.npy: not a readable NPY file"),
    ],
)
def test_a_bad_view_is_named(tmp_path: Path, view: dict[str, Any], said: str) -> None:
    np.save(tmp_path / "wide.npy", np.ones((2, 4), np.bool_))
    np.save(tmp_path / "float.npy", np.ones((2, 3)))
    (tmp_path / "text.npy").write_text("no array")
    with pytest.raises(PrunusError, match=said):
        read_rig(write(tmp_path, view))


@pytest.mark.parametrize(
    ("changes", "said"),
    [({"views": []}, "views"), ({"format": "rig"}, "format"), ({"version": 2}, "version"),
     ({"unit": "mm"}, "unit")],
)  # fmt: skip
def test_a_bad_rig_is_named(tmp_path: Path, changes: dict[str, Any], said: str) -> None:
    with pytest.raises(PrunusError, match=rf"rig\.json: {said}"):
        read_rig(write(tmp_path, **changes))


def test_a_folder_with_nothing_to_fuse_is_named(tmp_path: Path) -> None:
    with pytest.raises(PrunusError, match=r"holds neither rig\.json nor"):
        read_rig(tmp_path)
    with pytest.raises(PrunusError, match="not a folder"):
        read_rig(tmp_path / "absent")
    (tmp_path / "rig.json").write_text("{")
    with pytest.raises(PrunusError, match=r"rig\.json: not JSON: "):
        read_rig(tmp_path)
