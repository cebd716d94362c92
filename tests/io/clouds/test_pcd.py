"""PCD as PCL and its friends write it: with what may be missing, every colour, every encoding."""

import struct
from pathlib import Path

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import FileCloud, read_cloud

XYZ = np.round(np.random.default_rng(3).uniform(0, 1, (12, 3)), 3).astype(np.float32)
RGB = np.random.default_rng(4).integers(0, 256, (12, 3)).astype(np.uint8)
BITS = (RGB.astype(np.uint32) << np.array([16, 8, 0], np.uint32)).sum(axis=1).astype(np.uint32)
HEAD = {
    "VERSION": ".7", "FIELDS": "x y z", "SIZE": "4 4 4", "TYPE": "F F F", "COUNT": "1 1 1",
    "WIDTH": "12", "HEIGHT": "1", "VIEWPOINT": "0 0 0 1 0 0 0", "POINTS": "12", "DATA": "binary",
}  # fmt: skip


def pcd(body: bytes, end: str = "\n", **changes: str | None) -> bytes:
    lines = [f"{key} {word}" for key, word in (HEAD | changes).items() if word is not None]
    return end.join(["# .PCD v.7", *lines, ""]).encode() + body


def read(tmp_path: Path, content: bytes) -> FileCloud:
    (tmp_path / "a.pcd").write_bytes(content)
    return read_cloud(tmp_path / "a.pcd")


TEXT = b"".join(b"%.3f %.3f %.3f\n" % tuple(row) for row in XYZ)


@pytest.mark.parametrize("form", ["binary", "ascii", "ASCII", "Binary"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize(
    "missing",
    [
        ["COUNT"],
        ["VIEWPOINT"],
        ["POINTS"],
        ["HEIGHT"],
        ["VERSION"],
        ["WIDTH", "HEIGHT"],
        ["COUNT", "VIEWPOINT", "POINTS", "HEIGHT", "VERSION"],
    ],
)
def test_what_may_be_missing_is(tmp_path: Path, form: str, end: str, missing: list[str]) -> None:
    body = TEXT if form.lower() == "ascii" else XYZ.tobytes()
    content = pcd(body, end, **(dict.fromkeys(missing) | {"DATA": form}))
    assert read(tmp_path, content).xyz == pytest.approx(XYZ, abs=1e-6)


def test_organised_clouds_lose_the_pixels_that_saw_nothing(tmp_path: Path) -> None:
    holed = XYZ.copy()
    holed[[1, 5]] = np.nan
    cloud = read(tmp_path, pcd(holed.tobytes(), WIDTH="4", HEIGHT="3"))
    assert (cloud.xyz == np.delete(XYZ, [1, 5], axis=0)).all()
    assert cloud.notes == ["2 of 12 points are not finite (NaN) and were left out"]


def fields(names: str, size: str, kind: str, count: str | None = None) -> dict[str, str]:
    ones = " ".join("1" for _ in names.split())
    return {
        "FIELDS": f"x y z {names}", "SIZE": f"4 4 4 {size}", "TYPE": f"F F F {kind}",
        "COUNT": f"1 1 1 {count or ones}",
    }  # fmt: skip


def beside(*columns: np.ndarray) -> bytes:
    return b"".join(
        row.tobytes() + b"".join(column[k].tobytes() for column in columns)
        for k, row in enumerate(XYZ)
    )


SHARES = (RGB / 255).astype(np.float32)


@pytest.mark.parametrize(
    ("head", "body"),
    [
        (fields("rgb", "4", "F"), beside(BITS.view(np.float32))),
        (fields("rgb", "4", "U"), beside(BITS)),
        (fields("rgba", "4", "U"), beside(BITS | np.uint32(0xFF000000))),
        (fields("rgb", "4", "F"), beside((BITS | np.uint32(0xFF000000)).view(np.float32))),
        (fields("r g b", "1 1 1", "U U U"), beside(*RGB.T.copy())),
        (fields("red green blue", "4 4 4", "F F F"), beside(*SHARES.T.copy())),
        (fields("_ rgb", "1 4", "U U", "5 1"), beside(np.zeros((12, 5), np.uint8), BITS)),
    ],
)
def test_every_convention_of_colours(tmp_path: Path, head: dict[str, str], body: bytes) -> None:
    cloud = read(tmp_path, pcd(body, **head))
    assert (cloud.xyz == XYZ).all() and cloud.rgb is not None
    assert np.abs(cloud.rgb.astype(int) - RGB).max() <= ("F F F F F" in head["TYPE"])


@pytest.mark.parametrize("packed", [lambda bits: repr(float(bits.view(np.float32))), str])
def test_colours_in_text_are_bits_or_numbers(tmp_path: Path, packed: object) -> None:
    assert callable(packed)
    rows = [
        b"%.3f %.3f %.3f " % tuple(xyz) + packed(bits).encode()
        for xyz, bits in zip(XYZ, BITS, strict=True)
    ]
    cloud = read(tmp_path, pcd(b"\n".join(rows), DATA="ascii", **fields("rgb", "4", "F")))
    assert cloud.rgb is not None and (cloud.rgb == RGB).all()


def test_a_moved_viewpoint_is_said(tmp_path: Path) -> None:
    cloud = read(tmp_path, pcd(XYZ.tobytes(), VIEWPOINT="1 0 0 1 0 0 0"))
    assert (cloud.xyz == XYZ).all() and "VIEWPOINT" in cloud.notes[0]


def packed(held: bytes) -> bytes:
    import lzf

    small = lzf.compress(held, 2 * len(held))
    return struct.pack("<2I", len(small), len(held)) + small


def test_compressed_fields_stand_one_after_another(tmp_path: Path) -> None:
    body = XYZ.T.tobytes() + BITS.tobytes() + bytes(2400)
    head = fields("rgb _", "4 1", "U U", "1 200")
    cloud = read(tmp_path, pcd(packed(body), DATA="binary_compressed", **head))
    assert (cloud.xyz == XYZ).all() and (cloud.rgb == RGB).all()


MUCH = {"WIDTH": "999999999999", "POINTS": "999999999999"}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (pcd(XYZ[:5].tobytes()), "truncated: the header promises 12 points, the file holds 5"),
        (pcd(XYZ.tobytes()[:-1]), "truncated: .* holds 11"),
        (pcd(TEXT[: len(TEXT) // 2], DATA="ascii"), "truncated: .* holds 6"),
        (pcd(TEXT + TEXT, DATA="ascii"), "24 rows; the header promises 12"),
        (pcd(packed(XYZ.T.tobytes())[:-1], DATA="binary_compressed"), "truncated"),
        (pcd(b"\1\0\0\0", DATA="binary_compressed"), "truncated"),
        (pcd(packed(bytes(10)), DATA="binary_compressed"), "unpack to 10; 12 points need 144"),
        (
            pcd(struct.pack("<2I", 20, 144) + b"\xff" * 20, DATA="binary_compressed"),
            "not a readable",
        ),
        (
            pcd(struct.pack("<2I", 8, 2**32 - 1) + bytes(8), DATA="binary_compressed", **MUCH),
            "unpack",
        ),
        (pcd(XYZ.tobytes(), **MUCH), "truncated: .* holds 12"),
        (pcd(XYZ.tobytes(), POINTS="11"), "POINTS is 11, but WIDTH x HEIGHT 12"),
        (pcd(XYZ.tobytes(), WIDTH="-3"), "WIDTH is -3"),
        (pcd(XYZ.tobytes(), WIDTH=None, POINTS=None), "POINTS is missing"),
        (pcd(XYZ.tobytes(), SIZE="4 4"), "3 FIELDS, 2 SIZE"),
        (pcd(XYZ.tobytes(), TYPE="F F Q"), "'z' is of TYPE Q"),
        (pcd(XYZ.tobytes(), SIZE="4 4 3"), "SIZE 3"),
        (pcd(XYZ.tobytes(), COUNT="1 1 3"), "truncated"),
        (pcd(XYZ.tobytes(), FIELDS="x y w"), "no column 'z' among x, y, w"),
        (pcd(XYZ.tobytes(), DATA="zip"), "no line DATA ascii, binary"),
        (pcd(XYZ.tobytes(), DATA=None), "no line DATA"),
        (pcd(TEXT.replace(b"\n", b" 1\n"), DATA="ascii"), "rows hold 4 numbers; expected 3"),
        (pcd(b"1 2 oak\n" * 12, DATA="ascii"), "'oak'"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path: Path, content: bytes, said: str) -> None:
    with pytest.raises(PrunusError, match=rf"a\.pcd: .*{said}") as error:
        read(tmp_path, content)
    assert "\n" not in str(error.value)
