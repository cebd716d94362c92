"""Fuzz the readers of clouds: `python -m bench.fuzz .ply --seconds 600` (pip install atheris).

Whatever bytes a file holds, `read_cloud` gives points or raises a PrunusError. A finding is any
other exception, a crash, and an error of our own code (an index out of range, a wrong type) that
the door turned into a PrunusError. Inputs that failed are left in the folder given by --keep, and
become tests. Not part of CI: libFuzzer runs until its time is over.
"""

from __future__ import annotations

import argparse
import io
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import atheris
import numpy as np

with atheris.instrument_imports(include=["prunus.io", "laspy", "rosbags", "zipfile"]):
    import prunus.io
    from prunus.errors import PrunusError
    from prunus.io.clouds.cloud_file import _ply, _text, read_cloud
    from prunus.io.inputs import is_bag

OURS = (IndexError, KeyError, TypeError, AttributeError, UnboundLocalError, RecursionError)
"""Errors that say that code is wrong, not a file."""
XYZ = np.round(np.random.default_rng(0).uniform(-1, 1, (9, 3)), 3)
RGB = np.random.default_rng(1).integers(0, 256, (9, 3)).astype(np.uint8)


def ply_seeds() -> list[bytes]:
    """A binary and an ASCII PLY, with lists and edges."""
    rows = b"".join(b"%.3f %.3f %.3f 2 0 1\n" % tuple(row) for row in XYZ)
    head = b"element vertex 9\nproperty float x\nproperty float y\nproperty float z\n"
    listed = b"property list uchar int k\nelement edge 1\nproperty int vertex1\nend_header\n"
    return [
        _ply(XYZ, RGB),
        b"ply\nformat ascii 1.0\ncomment unit: metre\n" + head + listed + rows + b"3\n",
        b"ply\nformat binary_big_endian 1.0\n" + head + listed
        + b"".join(row.astype(">f4").tobytes() + b"\1\0\0\0\0" for row in XYZ),
    ]  # fmt: skip


def pcd_seeds() -> list[bytes]:
    """A PCD of each encoding."""
    from pypcd4 import Encoding, PointCloud  # type: ignore[attr-defined]

    seeds = []
    points = np.column_stack([XYZ, RGB[:, 0]]).astype(np.float32)
    with tempfile.TemporaryDirectory() as folder:
        for encoding in Encoding:
            PointCloud.from_xyzrgb_points(points).save(Path(folder) / "a.pcd", encoding)
            seeds.append((Path(folder) / "a.pcd").read_bytes())
    return seeds


def text_seeds() -> list[bytes]:
    """Text with and without names, comments, counts, words and decimal commas."""
    plain = _text(" ")(XYZ, RGB)
    return [
        plain, _text(",")(XYZ, RGB), b"# by hand\n9\n" + plain,
        b"\xef\xbb\xbf//X Y Z R G B\n" + plain,
        b'"x";"y [m]";z;class\n1,5;2,5;3,5;"old ""oak"""\n2,5;3,5;;oak\n',
        "x\ty\tz\r\n1,5\t2\t3\r\n".encode("utf-16"), b"3\n1 2 3 9\n2 3 4 9\n3 4 5 9\n1\n1 2 3 9\n",
    ]  # fmt: skip


def array_seeds() -> list[bytes]:
    """NPY of several kinds."""
    table = np.zeros((3, 3), [("x", "<f4"), ("y", ">f8"), ("z", "<f4"), ("r", "u1")])
    arrays = [XYZ, np.asfortranarray(XYZ.astype(np.float16)), table, XYZ.reshape(3, 3, 3)]
    return [_saved(np.save, array) for array in arrays]


def archive_seeds() -> list[bytes]:
    """NPZ, stored and packed."""
    return [_saved(save, xyz=XYZ, rgb=RGB) for save in (np.savez, np.savez_compressed)]


def _saved(save: Callable[..., None], *arrays: object, **named: object) -> bytes:
    out = io.BytesIO()
    save(out, *arrays, **named)
    return out.getvalue()


def las_seeds(ending: str) -> list[bytes]:
    """LAS or LAZ of two formats, with keys and with WKT."""
    import laspy
    from laspy.vlrs.known import WktCoordinateSystemVlr
    from laspy.vlrs.vlr import VLR

    seeds = []
    for form, version in ((2, "1.2"), (7, "1.4")):
        header = laspy.LasHeader(point_format=form, version=version)
        header.scales = np.full(3, 1e-3)
        keys = np.array([[1, 1, 0, 2], [1024, 0, 1, 1], [3076, 0, 1, 9003]], "<u2").tobytes()
        header.vlrs.append(VLR("LASF_Projection", 34735, "keys", keys))
        if form == 7:
            header.vlrs.append(WktCoordinateSystemVlr('PROJCS["a",UNIT["metre",1]]'))
        las = laspy.LasData(header)
        las.x, las.y, las.z = XYZ.T
        las.red, las.green, las.blue = RGB.T
        out = io.BytesIO()
        las.write(out, do_compress=ending == ".laz")
        seeds.append(out.getvalue())
    return seeds


def e57_seeds() -> list[bytes]:
    """E57 with a pose and colours."""
    import pye57

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.e57"
        with pye57.E57(str(path), mode="w") as file:
            data = {f"cartesian{axis}": XYZ[:, k] for k, axis in enumerate("XYZ")}
            colours = {f"color{name}": RGB[:, k] for k, name in enumerate(("Red", "Green", "Blue"))}
            turn = np.array([0.5, 0.5, 0.5, 0.5])
            file.write_scan_raw(data | colours, rotation=turn, translation=np.ones(3))
        return [path.read_bytes()]


def bag_seeds(kind: str) -> list[bytes]:
    """A recording of one cloud."""
    from tests.recordings import Recording, table_of

    with tempfile.TemporaryDirectory() as folder:
        recording = Recording(kind)
        recording.cloud("/points", table_of(XYZ.astype(np.float32)))
        path = recording.write(Path(folder))
        ending = {"sqlite3": "*.db3", "mcap": "*.mcap"}.get(kind)
        return [(next(path.glob(ending)) if ending else path).read_bytes()]


SEEDS: dict[str, Callable[[], list[bytes]]] = {
    ".ply": ply_seeds,
    ".xyz": text_seeds,
    ".pts": text_seeds,
    ".pcd": pcd_seeds,
    ".npy": array_seeds,
    ".npz": archive_seeds,
    ".las": lambda: las_seeds(".las"),
    ".laz": lambda: las_seeds(".laz"),
    ".e57": e57_seeds,
    ".mcap": lambda: bag_seeds("mcap"),
    ".db3": lambda: bag_seeds("sqlite3"),
    ".bag": lambda: bag_seeds("ros1"),
}
"""By the ending of the file."""

TABLE = np.arange(256, dtype=np.uint32)
for _ in range(8):
    TABLE = np.where(TABLE & 1, (TABLE >> 1) ^ np.uint32(0x82F63B78), TABLE >> 1)


def with_checksums(content: bytes) -> bytes:
    """An E57 whose pages have right checksums: CRC-32C behind each 1020 bytes."""
    pages = []
    for at in range(0, len(content) - 1023, 1024):
        page, crc = content[at : at + 1020], 0xFFFFFFFF
        for byte in page:
            crc = (crc >> 8) ^ int(TABLE[(crc ^ byte) & 0xFF])
        pages.append(page + (crc ^ 0xFFFFFFFF).to_bytes(4, "big"))
    return b"".join(pages)


def check(content: bytes, path: Path) -> None:
    """Read bytes as a file; an error of our own code is raised."""
    path.write_bytes(content)
    try:
        read_cloud(path)
    except PrunusError as error:
        ours = isinstance(error.__cause__, OURS) and _in_ours(error.__cause__)
        # A recording brings the definitions of its messages, so which fields they have.
        if ours and not (is_bag(path) and isinstance(error.__cause__, AttributeError)):
            raise error.__cause__ from None  # type: ignore[misc]


def _in_ours(error: BaseException) -> bool:
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    home = str(Path(prunus.io.__file__).parent)
    return trace is not None and trace.tb_frame.f_code.co_filename.startswith(home)


def main() -> None:
    """Fuzz one reader."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ending", choices=sorted(SEEDS))
    parser.add_argument("--seconds", type=int, default=600)
    parser.add_argument("--keep", type=Path, default=Path("prunus-out/fuzz"))
    asked = parser.parse_args()
    corpus = asked.keep / asked.ending[1:]
    corpus.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(SEEDS[asked.ending]()):
        (corpus / f"seed{number}").write_bytes(seed)
    with tempfile.TemporaryDirectory(
        dir="/dev/shm" if Path("/dev/shm").is_dir() else None
    ) as folder:
        path = Path(folder) / f"a{asked.ending}"
        ready = with_checksums if asked.ending == ".e57" else bytes
        for seed in SEEDS[asked.ending]():
            check(ready(seed), path)
        flags = [
            f"-max_total_time={asked.seconds}", "-max_len=65536", "-timeout=60",
            "-rss_limit_mb=4096", f"-artifact_prefix={corpus}-", "-print_final_stats=1",
            str(corpus),
        ]  # fmt: skip
        atheris.Setup([sys.argv[0], *flags], lambda content: check(ready(content), path))
        atheris.Fuzz()


if __name__ == "__main__":
    main()
