"""Recordings of robots: every kind read back to the digit, every fault refused by name."""

import hashlib
import sqlite3
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import read_cloud
from prunus.io.ros import bags
from prunus.io.ros.messages import undistorted
from tests.recordings import KINDS, Recording, table_of

pytest.importorskip("rosbags")

XYZ = np.random.default_rng(0).uniform(-1, 1, (60, 3)).astype(np.float32)
RGB = np.random.default_rng(1).integers(0, 256, (60, 3)).astype(np.uint8)
QUARTER = (0, 0, np.sqrt(0.5), np.sqrt(0.5))
"""A quarter turn about Z, as a quaternion."""


@pytest.fixture(params=KINDS)
def recording(request: pytest.FixtureRequest) -> Recording:
    return Recording(request.param)


@pytest.fixture
def mcap() -> Recording:
    return Recording("mcap")


def test_a_cloud_comes_back_to_the_digit(recording: Recording, tmp_path: Path) -> None:
    recording.word("/chatter", "hello")
    recording.cloud("/points", table_of(XYZ))
    cloud = read_cloud(recording.write(tmp_path))
    assert cloud.xyz.dtype == np.float64 and (cloud.xyz == XYZ).all() and cloud.rgb is None
    assert cloud.notes == [
        "topic /points: 1 message joined",
        "in the frame 'lidar' of the sensor",
    ]


@pytest.mark.parametrize("kind", ["sqlite3", "mcap"])
def test_a_file_of_a_ros_2_bag_is_read_alone(kind: str, tmp_path: Path) -> None:
    recording = Recording(kind)
    recording.cloud("/points", table_of(XYZ))
    folder = recording.write(tmp_path)
    file = next(path for path in folder.iterdir() if path.suffix in (".db3", ".mcap"))
    (folder / "metadata.yaml").unlink()
    cloud = read_cloud(file)
    assert (cloud.xyz == XYZ).all()
    assert cloud.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()


def test_a_bag_of_old_ros_2_holds_no_definitions(tmp_path: Path) -> None:
    """Up to Humble, `ros2 bag record` wrote SQLite without the definitions of the messages."""
    recording = Recording("sqlite3")
    recording.cloud("/points", table_of(XYZ))
    folder = recording.write(tmp_path)
    with closing(sqlite3.connect(folder / "rec.db3")) as base, base:
        base.execute("DELETE FROM message_definitions")
    assert (read_cloud(folder).xyz == XYZ).all()


def test_the_digest_of_a_folder_is_over_its_files_by_name(mcap: Recording, tmp_path: Path) -> None:
    mcap.cloud("/points", table_of(XYZ))
    folder = mcap.write(tmp_path)
    content = b"".join(path.read_bytes() for path in sorted(folder.iterdir()))
    assert read_cloud(folder).sha256 == hashlib.sha256(content).hexdigest()


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("number", ["f4", "f8"])
@pytest.mark.parametrize("packed", ["f4", "u4"])
def test_any_order_of_fields_bytes_and_padding(
    mcap: Recording, tmp_path: Path, order: str, number: str, packed: str
) -> None:
    kind = np.dtype(
        {
            "names": ["z", "ring", "rgb", "x", "y"],
            "formats": [
                order + number,
                order + "u2",
                order + packed,
                order + number,
                order + number,
            ],
            "offsets": [4, 12, 16, 24, 32],
            "itemsize": 48,
        }
    )
    table = np.zeros(60, kind)
    table["x"], table["y"], table["z"] = XYZ.T
    red, green, blue = RGB.T.astype(np.uint32)
    bits = (red << 16 | green << 8 | blue).astype(order + "u4")
    table["rgb"] = bits.view(order + packed)
    mcap.cloud("/points", table, pad=7, height=5)
    cloud = read_cloud(mcap.write(tmp_path))
    assert (cloud.xyz == XYZ).all()
    assert cloud.rgb is not None and (cloud.rgb == RGB).all()


def test_colours_in_three_fields(mcap: Recording, tmp_path: Path) -> None:
    kinds = [(axis, "<f4") for axis in "xyz"] + [(colour, "u1") for colour in "rgb"]
    table = np.zeros(60, kinds)
    for name, values in zip("xyzrgb", [*XYZ.T, *RGB.T], strict=True):
        table[name] = values
    mcap.cloud("/points", table)
    rgb = read_cloud(mcap.write(tmp_path)).rgb
    assert rgb is not None and (rgb == RGB).all()


def test_points_that_saw_nothing_are_left_out_and_said(mcap: Recording, tmp_path: Path) -> None:
    holed = XYZ.copy()
    holed[3:9], holed[20, 1] = np.nan, np.inf
    mcap.cloud("/points", table_of(holed))
    cloud = read_cloud(mcap.write(tmp_path))
    assert (cloud.xyz == np.delete(XYZ, [3, 4, 5, 6, 7, 8, 20], axis=0)).all()
    assert "7 of 60 points saw nothing (NaN) and were left out" in cloud.notes


def test_clouds_of_a_standing_sensor_are_joined_as_they_are(
    recording: Recording, tmp_path: Path
) -> None:
    recording.joint("base", "lidar", (5, 0, 0))
    recording.cloud("/points", table_of(XYZ[:20]), time=1)
    recording.cloud("/points", table_of(XYZ[20:]), time=2)
    cloud = read_cloud(recording.write(tmp_path))
    assert (cloud.xyz == XYZ).all()
    assert cloud.notes == [
        "topic /points: 2 messages joined",
        "in the frame 'lidar' of the sensor, which no tf moves",
    ]


def test_clouds_of_a_moving_sensor_are_joined_in_the_root(
    recording: Recording, tmp_path: Path
) -> None:
    """At 1 s the arm is at x = 0, at 3 s at x = 2 and a quarter turn on; at 2 s half way."""
    recording.joint("arm", "/lidar", (0, 0, 1))
    recording.joint("map", "arm", (0, 0, 0), time=1, topic="/tf")
    recording.joint("map", "arm", (2, 0, 0), QUARTER, time=3, topic="/tf")
    for time in (1, 2, 3):
        recording.cloud("/points", table_of([[1, 0, 0]]), time=time)
    cloud = read_cloud(recording.write(tmp_path))
    half = np.sqrt(0.5)
    assert cloud.xyz == pytest.approx(
        np.array([[1, 0, 1], [1 + half, half, 1], [2, 1, 1]]), abs=1e-12
    )
    assert "in the frame 'map', through tf" in cloud.notes


def test_clouds_in_two_frames_are_joined_in_their_root(mcap: Recording, tmp_path: Path) -> None:
    mcap.joint("base", "left", (0, 1, 0))
    mcap.joint("base", "right", (0, -1, 0), QUARTER)
    mcap.cloud("/points", table_of([[1, 0, 0]]), "left")
    mcap.cloud("/points", table_of([[1, 0, 0]]), "right")
    assert read_cloud(mcap.write(tmp_path)).xyz == pytest.approx(np.array([[1, 1, 0], [0, 0, 0]]))


def test_messages_without_a_transform_in_time_are_left_out(mcap: Recording, tmp_path: Path) -> None:
    mcap.joint("map", "lidar", (0, 0, 0), time=10, topic="/tf")
    mcap.joint("map", "lidar", (1, 0, 0), time=11, topic="/tf")
    for time in (2, 9.5, 11.5):
        mcap.cloud("/points", table_of([[time, 0, 0]]), time=time)
    cloud = read_cloud(mcap.write(tmp_path))
    assert cloud.xyz[:, 0].tolist() == [9.5, 12.5]
    assert cloud.notes[-1] == "1 of 3 messages left out: no tf within a second of them"


def test_a_long_recording_is_thinned_and_says_so(
    mcap: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bags, "MOST", 25)
    for time in range(1, 7):
        mcap.cloud("/points", table_of(XYZ[10:20] if time == 5 else XYZ[:10]), time=time)
    cloud = read_cloud(mcap.write(tmp_path))
    assert len(cloud.xyz) == 20
    assert cloud.notes[0].startswith("topic /points: 2 messages joined, one in 4 of 6")
    assert (cloud.xyz == np.concatenate([XYZ[:10], XYZ[10:20]])).all()


DEPTH = np.array([[1.0, 2.0, 0.0], [0.5, 4.0, 1.5]])


@pytest.mark.parametrize(
    ("encoding", "kind"), [("16UC1", "<u2"), ("16UC1", ">u2"), ("32FC1", "<f4"), ("32FC1", ">f4")]
)
def test_depth_images_become_points_in_the_optical_frame(
    recording: Recording, tmp_path: Path, encoding: str, kind: str
) -> None:
    """Three pixels wide, two high, focal length 2 pixels, the axis through column 1, row 1."""
    pixels = (DEPTH * (1000 if encoding == "16UC1" else 1)).astype(kind)
    if encoding == "32FC1":
        pixels[0, 2] = np.nan
    recording.image("/eye/depth/image_raw", pixels, encoding)
    recording.camera("/eye/depth/camera_info", (2, 3), 2.0)
    recording.image("/eye/color/image_raw", np.zeros((2, 3), "u1"), "mono8")
    recording.camera("/eye/color/camera_info", (2, 3), 2.0)
    cloud = read_cloud(recording.write(tmp_path))
    assert cloud.xyz.tolist() == [
        [-0.5, -0.5, 1.0], [0.0, -1.0, 2.0], [-0.25, 0.0, 0.5], [0.0, 0.0, 4.0], [0.75, 0.0, 1.5],
    ]  # fmt: skip
    assert "1 of 6 points saw nothing (NaN) and were left out" in cloud.notes


def test_depth_images_of_a_moving_camera_are_joined(recording: Recording, tmp_path: Path) -> None:
    recording.camera("/eye/camera_info", (1, 1), 2.0)
    for time, depth in [(1, 1000), (2, 2000)]:
        recording.joint("base", "eye", (0, time, 0), time=time, topic="/tf")
        recording.image("/eye/depth", np.array([[depth]], "<u2"), "16UC1", time=time)
    assert read_cloud(recording.write(tmp_path)).xyz.tolist() == [[0, 1, 1], [0, 2, 2]]


def test_the_distortion_of_a_lens_is_taken_out() -> None:
    lens = np.array([-0.2, 0.05, 0.001, -0.002, 0.01])
    x, y = rays = np.random.default_rng(0).uniform(-0.5, 0.5, (2, 100))
    k1, k2, p1, p2, k3 = lens
    r2 = x * x + y * y
    swell = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    seen = np.column_stack(
        [
            x * swell + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * swell + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ]
    )
    assert undistorted(seen, lens) == pytest.approx(rays.T, abs=1e-9)


def test_one_topic_of_several_is_named_behind_the_path(
    recording: Recording, tmp_path: Path
) -> None:
    recording.cloud("/left/points", table_of(XYZ[:20]))
    recording.cloud("/right/points", table_of(XYZ[20:]))
    path = recording.write(tmp_path)
    with pytest.raises(PrunusError, match="2 topics hold point clouds; expected one") as refusal:
        read_cloud(path)
    text = str(refusal.value)
    assert f"'{path}#/left/points'" in text
    assert "/right/points (sensor_msgs/msg/PointCloud2, 1 message)" in text
    cloud = read_cloud(f"{path}#/right/points")
    assert (cloud.xyz == XYZ[20:]).all() and cloud.name == f"{path.name}#/right/points"
    assert (read_cloud(f"{path}#left/points").xyz == XYZ[:20]).all()
    with pytest.raises(PrunusError, match=r"#/up: no such topic .* The bag holds /left/points"):
        read_cloud(f"{path}#/up")


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_with_the_mark_in_its_name_is_a_file(kind: str, tmp_path: Path) -> None:
    np.savetxt(tmp_path / "tree.bag#1.xyz", XYZ)
    assert len(read_cloud(tmp_path / "tree.bag#1.xyz").xyz) == 60
    recording = Recording(kind)
    recording.cloud("/points", table_of(XYZ))
    path = recording.write(tmp_path).rename(tmp_path / f"row #7?%20{'.bag' * (kind == 'ros1')}")
    assert (read_cloud(path).xyz == XYZ).all()
    assert (read_cloud(f"{path}#/points").xyz == XYZ).all()


def faulty(name: str) -> Recording:
    """A recording with one fault."""
    made = Recording("mcap")
    for time in (1, 2):
        frame = f"eye{time}" if name == "apart" else "eye"
        made.cloud("/points", table_of(XYZ), frame, time=time, cut=9 * (name == "cut"))
    if name == "two parents":
        made.joint("a", "eye", (0, 0, 0), topic="/tf")
        made.joint("b", "eye", (0, 0, 1), topic="/tf")
    if name == "no turn":
        made.joint("a", "eye", (0, 0, 0), (0, 0, 0, 0))
    if name == "late":
        made.joint("a", "eye", (0, 0, 0), time=100, topic="/tf")
        made.joint("a", "eye", (0, 0, 1), time=101, topic="/tf")
    return made


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("apart", "no transform connects .*'eye1' leads up to 'eye1', 'eye2' leads up to 'eye2'"),
        ("cut", "truncated: 60 x 1 need 720 bytes, the message holds 711"),
        ("two parents", "the frame 'eye' hangs on 'a' and on 'b'; expected one parent"),
        ("no turn", "the transform from 'eye' to 'a' is none; expected .* a unit quaternion"),
        ("late", "all 2 messages lie more than a second before or after the transforms to 'a'"),
    ],
)
def test_a_faulty_recording_is_refused_by_name(tmp_path: Path, name: str, message: str) -> None:
    path = faulty(name).write(tmp_path)
    with pytest.raises(PrunusError, match=f"{path}.*: .*{message}"):
        read_cloud(path)


def test_clouds_and_images_of_the_wrong_kind_are_refused(mcap: Recording, tmp_path: Path) -> None:
    mcap.cloud("/whole", table_of(XYZ * 1000, "<i4"))
    mcap.cloud("/flat", table_of(XYZ)[["x", "y"]])
    mcap.image("/colour/image", np.zeros((2, 3), "u1"), "mono8")
    mcap.camera("/colour/camera_info", (2, 3), 2.0)
    mcap.image("/alone/depth", np.ones((2, 3), "<u2"), "16UC1")
    mcap.image("/small/depth", np.ones((2, 3), "<u2"), "16UC1")
    mcap.camera("/small/camera_info", (4, 6), 2.0)
    mcap.image("/fish/depth", np.ones((2, 3), "<u2"), "16UC1")
    mcap.camera("/fish/camera_info", (2, 3), 2.0, [0.1], "equidistant")
    mcap.word("/words", "no cloud")
    path = mcap.write(tmp_path)
    for topic, message in {
        "/whole": "the field 'x' holds whole numbers; expected floats",
        "/flat": "no column 'z' among x, y",
        "/colour/image": "the image is 'mono8'; expected depth",
        "/alone/depth": "no camera info for the image; expected the topic /alone/camera_info",
        "/small/depth": "3 x 2 pixels, its camera info is for 6 x 4",
        "/fish/depth": "the lens is 'equidistant'",
        "/words": "no such topic of clouds or images",
    }.items():
        with pytest.raises(PrunusError, match=f"{path}#{topic}: .*{message}"):
            read_cloud(f"{path}#{topic}")


def test_a_recording_without_clouds_lists_what_it_holds(
    recording: Recording, tmp_path: Path
) -> None:
    recording.word("/chatter", "hello")
    path = recording.write(tmp_path)
    with pytest.raises(PrunusError, match=r"0 topics hold depth images .*/chatter \(std_msgs/msg/"):
        read_cloud(path)


@pytest.mark.parametrize("ending", [".bag", ".mcap", ".db3"])
@pytest.mark.parametrize(
    "content", [b"no recording at all" * 99, b"\x89MCAP0\r\n", b"#ROSBAG V2.0\n"]
)
def test_what_is_no_recording_is_refused(tmp_path: Path, ending: str, content: bytes) -> None:
    (tmp_path / f"c{ending}").write_bytes(content)
    with pytest.raises(PrunusError, match=f"c{ending}: not a readable bag: ."):
        read_cloud(tmp_path / f"c{ending}")


def test_a_truncated_recording_is_refused(recording: Recording, tmp_path: Path) -> None:
    recording.cloud("/points", table_of(np.tile(XYZ, (500, 1))))
    path = recording.write(tmp_path)
    file = path if path.is_file() else next(p for p in path.iterdir() if p.suffix != ".yaml")
    for share in (0.2, 0.6, 0.95):
        file.write_bytes(file.read_bytes()[: int(share * file.stat().st_size)])
        with pytest.raises(PrunusError, match=f"{path}: not a readable bag: ."):
            read_cloud(path)


def test_empty_and_missing_recordings_are_refused(tmp_path: Path) -> None:
    (tmp_path / "empty.bag").write_bytes(b"")
    with pytest.raises(PrunusError, match=r"empty.bag: the file is empty"):
        read_cloud(tmp_path / "empty.bag")
    for path in ("none.mcap", "none.mcap#/points"):
        with pytest.raises(PrunusError, match=r"none.mcap: cannot be read \(No such file"):
            read_cloud(tmp_path / path)


def test_without_rosbags_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "c.bag").write_bytes(b"#ROSBAG V2.0\n")
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(PrunusError, match=r"c.bag: .*pip install 'prunus\[bags\]'"):
        read_cloud(tmp_path / "c.bag")


def test_an_index_that_promises_messages_which_are_not_there_is_refused(
    mcap: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mcap.cloud("/points", table_of(XYZ))
    folder = mcap.write(tmp_path)
    monkeypatch.setattr(bags, "messages", lambda *_: iter(()))
    with pytest.raises(PrunusError, match="no message on /points, though the index promises some"):
        read_cloud(folder)
