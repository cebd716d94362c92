"""LAS and LAZ: the unit that the header tells, in keys and in WKT; no header is trusted."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pytest
from laspy.vlrs.known import WktCoordinateSystemVlr
from laspy.vlrs.vlr import VLR

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import FileCloud, read_cloud
from prunus.io.lidar.reference import of_wkt

XYZ = np.round(np.random.default_rng(0).uniform(-1, 1, (60, 3)), 3)
FOOT, SURVEY_FOOT = 0.3048, 1200 / 3937


def keys(*pairs: tuple[int, int]) -> VLR:
    rows = [(1, 1, 0, len(pairs)), *((key, 0, 1, value) for key, value in pairs)]
    return VLR("LASF_Projection", 34735, "", np.array(rows, "<u2").tobytes())


def las(*records: VLR | WktCoordinateSystemVlr, packed: bool = False, form: int = 2) -> bytes:
    header = laspy.LasHeader(point_format=form, version="1.4" if form > 5 else "1.2")
    header.scales = np.full(3, 1e-4)
    header.vlrs.extend(records)
    held = laspy.LasData(header)
    held.x, held.y, held.z = XYZ.T
    out = io.BytesIO()
    held.write(out, do_compress=packed)
    return out.getvalue()


def read(tmp_path: Path, content: bytes, unit: str | None = None, name: str = "a.las") -> FileCloud:
    (tmp_path / name).write_bytes(content)
    return read_cloud(tmp_path / name, unit)


GEOGCS = (
    'GEOGCS["WGS 84",DATUM["d",SPHEROID["s",6378137,298.25]],UNIT["degree",0.0174532925199433]]'
)
PROJCS = f'PROJCS["a, [b]",{GEOGCS},PROJECTION["tm"],PARAMETER["false_easting",500000],UNIT[%s]]'
METRE, FEET = '"metre",1', '"US survey foot",0.304800609601219'
LOCAL = 'LOCAL_CS["mine",LOCAL_DATUM["a",0],UNIT[%s],AXIS["X",EAST]]'
WKT2 = """PROJCRS["a",BASEGEOGCRS["WGS 84",
DATUM["d",ELLIPSOID["e",6378137,298.25,LENGTHUNIT["metre",1]]],
PRIMEM["Greenwich",0,ANGLEUNIT["degree",0.0174532925199433]]],CONVERSION["c",METHOD["m"],
PARAMETER["False easting",5e5,LENGTHUNIT["metre",1]]],CS[Cartesian,2],
AXIS["(E)",east,ORDER[1],LENGTHUNIT["foot",0.3048]],AXIS["(N)",north,LENGTHUNIT["foot",0.3048]]]"""
GEOGCRS = """GEOGCRS["WGS 84",DATUM["d",ELLIPSOID["e",6378137,298.25,LENGTHUNIT["metre",1]]],
CS[ellipsoidal,2],AXIS["lat",north,ANGLEUNIT["degree",0.01745]],AXIS["lon",east,ANGLEUNIT["degree",0.01745]]]"""
GEODCRS = """GEODCRS["WGS 84",DATUM["d",ELLIPSOID["e",6378137,298.25,LENGTHUNIT["metre",1]]],
CS[Cartesian,3],AXIS["(X)",geocentricX],AXIS["(Y)",geocentricY],LENGTHUNIT["metre",1]]"""
GEOCCS = 'GEOCCS["a",DATUM["d",SPHEROID["s",6378137,298.25]],UNIT["metre",1]]'


@pytest.mark.parametrize(
    ("record", "metres"),
    [
        (keys((1024, 1), (3076, 9001)), 1),
        (keys((1024, 1), (3076, 9002)), FOOT),
        (keys((3072, 2229), (3076, 9003)), SURVEY_FOOT),
        (keys((1024, 1), (3072, 32631)), 1),
        (keys((1024, 1), (2048, 4326), (3072, 32767), (3076, 9002)), FOOT),
        (WktCoordinateSystemVlr(PROJCS % METRE), 1),
        (WktCoordinateSystemVlr(PROJCS % FEET), SURVEY_FOOT),
        (WktCoordinateSystemVlr(LOCAL % '"foot", 0.3048'), FOOT),
        (WktCoordinateSystemVlr(LOCAL % '"millimetre",0.001'), 0.001),
        (WktCoordinateSystemVlr(WKT2), FOOT),
        (
            WktCoordinateSystemVlr(f'COMPD_CS["c",{PROJCS % FEET},VERT_CS["v",UNIT[{FEET}]]]'),
            SURVEY_FOOT,
        ),
    ],
)
@pytest.mark.parametrize("packed", [False, True])
def test_the_unit_of_the_header_counts(
    tmp_path: Path, record: Any, metres: float, packed: bool
) -> None:
    cloud = read(tmp_path, las(record, packed=packed), name="a.laz" if packed else "a.las")
    assert cloud.xyz == pytest.approx(XYZ * metres, abs=1e-6)
    assert [note for note in cloud.notes if "as the header tells" in note] == cloud.notes
    assert bool(cloud.notes) == (metres != 1)


def test_a_unit_that_is_asked_for_wins_and_it_is_said(tmp_path: Path) -> None:
    cloud = read(tmp_path, las(keys((3076, 9003))), "ft")
    assert cloud.xyz == pytest.approx(XYZ * FOOT, abs=1e-6)
    assert cloud.notes == ["unit ft as asked, but the header tells us-ft"]
    same = read(tmp_path, las(keys((3076, 9003))), "us-ft")
    assert same.notes == ["unit us-ft as asked: all that is written is in metres"]


def test_heights_in_another_unit_are_brought_to_that_of_x_and_y(tmp_path: Path) -> None:
    cloud = read(tmp_path, las(keys((3076, 9001), (4099, 9002))))
    assert cloud.xyz == pytest.approx(XYZ * [1, 1, FOOT], abs=1e-6)
    assert "heights in ft, x and y in m" in cloud.notes[0]
    wkt = f'COMPD_CS["c",{PROJCS % FEET},VERT_CS["v",VERT_DATUM["d",5],UNIT["metre",1]]]'
    cloud = read(tmp_path, las(WktCoordinateSystemVlr(wkt)))
    assert cloud.xyz == pytest.approx(XYZ * [SURVEY_FOOT, SURVEY_FOOT, 1], abs=1e-6)


@pytest.mark.parametrize(
    ("record", "said"),
    [
        (keys((1024, 2), (2048, 4326)), "degrees"),
        (keys((2048, 4326)), "degrees"),
        (keys((1024, 3), (2048, 4978)), "geocentric"),
        (WktCoordinateSystemVlr(GEOGCS), "degrees"),
        (WktCoordinateSystemVlr(GEOGCRS), "degrees"),
        (WktCoordinateSystemVlr(f'COMPD_CS["a",{GEOGCS},VERT_CS["v",UNIT["metre",1]]]'), "degrees"),
        (WktCoordinateSystemVlr(GEOCCS), "geocentric"),
        (WktCoordinateSystemVlr(GEODCRS), "geocentric"),
    ],
)
def test_what_is_no_length_is_refused_unless_it_is_asked_for(
    tmp_path: Path, record: Any, said: str
) -> None:
    with pytest.raises(PrunusError, match=rf"a\.las: .*{said}.*--unit m"):
        read(tmp_path, las(record))
    cloud = read(tmp_path, las(record), "m")
    assert cloud.xyz == pytest.approx(XYZ, abs=1e-6)
    assert said in cloud.notes[0] and "unit m as asked, but" in cloud.notes[0]


@pytest.mark.parametrize(
    ("record", "notes"),
    [
        (keys((3072, 2229)), ["the header gives EPSG:2229, but no unit"]),
        (
            keys((1024, 1), (3076, 9005)),
            ["the header gives x and y in the unit EPSG:9005, which is not known"],
        ),
        (WktCoordinateSystemVlr("nonsense [["), []),
        (WktCoordinateSystemVlr('PROJCS["a"]'), []),
        (keys(), []),
    ],
)
def test_what_the_header_does_not_tell_is_metres(
    tmp_path: Path, record: Any, notes: list[str]
) -> None:
    cloud = read(tmp_path, las(record))
    assert cloud.xyz == pytest.approx(XYZ, abs=1e-6) and cloud.notes == notes


def test_units_that_are_rounded_in_another_way_are_the_same(tmp_path: Path) -> None:
    wkt = f'COMPD_CS["c",{PROJCS % FEET},VERT_CS["v",UNIT["ftUS",0.3048006096]]]'
    cloud = read(tmp_path, las(WktCoordinateSystemVlr(wkt)))
    assert cloud.notes == ["unit us-ft, as the header tells: all that is written is in metres"]


def test_a_wide_scan_is_believed_where_its_header_tells_metres(tmp_path: Path) -> None:
    header = laspy.LasHeader(point_format=0)
    header.scales = np.full(3, 1e-3)
    for told, wide in ((True, 400), (False, 40), (True, 4000), (False, 400)):
        header.vlrs.clear()
        header.vlrs.extend([keys((3076, 9001))] * told)
        held = laspy.LasData(header)
        held.x, held.y, held.z = (XYZ * [wide / 2, 1, 1]).T
        held.write(tmp_path / "a.las")
        if wide < (1000 if told else 50):
            assert np.ptp(read_cloud(tmp_path / "a.las").xyz[:, 0]) > 0.9 * wide
        else:
            with pytest.raises(PrunusError, match="say --unit"):
                read_cloud(tmp_path / "a.las")


def test_withheld_points_are_left_out(tmp_path: Path) -> None:
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales = np.full(3, 1e-4)
    held = laspy.LasData(header)
    held.x, held.y, held.z = XYZ.T
    held.withheld = np.arange(60) < 7
    held.write(tmp_path / "a.laz")
    cloud = read_cloud(tmp_path / "a.laz")
    assert cloud.xyz == pytest.approx(XYZ[7:], abs=1e-6)
    assert cloud.notes == ["7 of 60 points are withheld and were left out"]


def changed(content: bytes, at: int, value: int, size: int) -> bytes:
    return content[:at] + value.to_bytes(size, "little") + content[at + size :]


@pytest.mark.parametrize(
    ("form", "change"),
    [
        (2, lambda c: changed(c, 100, 2**32 - 1, 4)),  # records in the header
        (2, lambda c: changed(c, 107, 2**32 - 1, 4)),  # points
        (7, lambda c: changed(c, 243, 2**32 - 1, 4)),  # records behind the points
        (7, lambda c: changed(c, 247, 2**63, 8)),  # points, LAS 1.4
        (2, lambda c: changed(c, 131, 0, 8)),  # the scale of x
        (2, lambda c: changed(c, 105, 1, 2)),  # bytes of a point
        (2, lambda c: changed(c, 96, 2**31, 4)),  # where points begin
    ],
)
@pytest.mark.parametrize("packed", [False, True])
def test_a_lying_header_is_refused_soon(
    tmp_path: Path, form: int, change: Callable[[bytes], bytes], packed: bool
) -> None:
    name = "a.laz" if packed else "a.las"
    with pytest.raises(PrunusError, match=name.replace(".", r"\.") + ": "):
        read(tmp_path, change(las(form=form, packed=packed)), name=name)


@pytest.mark.parametrize("form", [2, 7])
@pytest.mark.parametrize("table", [-1, 0, 2**40, -(2**40), None])
def test_a_damaged_table_of_chunks_is_refused(tmp_path: Path, form: int, table: int | None) -> None:
    content = las(form=form, packed=True)
    begin = int.from_bytes(content[96:100], "little")
    at = int.from_bytes(content[begin : begin + 8], "little")
    if table is None:
        content = changed(content, at + 4, 2**32 - 1, 4)
    else:
        content = content[:begin] + table.to_bytes(8, "little", signed=True) + content[begin + 8 :]
    with pytest.raises(PrunusError, match=r"a\.laz: truncated or damaged: a table of chunks"):
        read(tmp_path, content, name="a.laz")


@pytest.mark.parametrize("form", [6, 7, 8, 10])
def test_a_damaged_layer_is_refused(tmp_path: Path, form: int) -> None:
    content = las(form=form, packed=True)
    begin = int.from_bytes(content[96:100], "little")
    size = int.from_bytes(content[105:107], "little")
    for layer in range(9):
        torn = changed(content, begin + 8 + size + 4 + 4 * layer, 2**32 - 9, 4)
        with pytest.raises(PrunusError, match=r"a\.laz: truncated or damaged: a chunk of points"):
            read(tmp_path, torn, name="a.laz")


def test_a_laz_that_does_not_say_how_it_is_packed_is_refused(tmp_path: Path) -> None:
    content = las(packed=True).replace(b"laszip encoded", b"laszip decoded")
    with pytest.raises(PrunusError, match=r"a\.laz: no record in the header says how"):
        read(tmp_path, content, name="a.laz")


@pytest.mark.parametrize(("at", "size"), [(12, 4), (36, 2), (42, 2)])
def test_a_record_of_no_points_is_refused(tmp_path: Path, at: int, size: int) -> None:
    content = las(packed=True)
    record = content.index(b"laszip encoded") - 2 + 54
    with pytest.raises(PrunusError, match=r"a\.laz: the record .* fits no such points"):
        read(tmp_path, changed(content, record + at, 0, size), name="a.laz")


@pytest.mark.parametrize("form", [0, 3, 6, 7, 8, 10])
@pytest.mark.slow
def test_many_chunks_and_further_bytes_are_read(tmp_path: Path, form: int) -> None:
    header = laspy.LasHeader(point_format=form, version="1.4")
    header.add_extra_dim(laspy.ExtraBytesParams("reflectance", "u2"))
    header.scales = np.full(3, 1e-4)
    held = laspy.LasData(header)
    xyz = np.tile(XYZ, (1000, 1))
    held.x, held.y, held.z = xyz.T
    held.write(tmp_path / "a.laz")
    assert read_cloud(tmp_path / "a.laz").xyz == pytest.approx(xyz, abs=1e-6)


def test_brackets_without_end_are_an_error_of_the_file(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="too deep"):
        of_wkt("A[" * 10_000)
    with pytest.raises(PrunusError, match=r"a\.las: not a readable LAS or LAZ file: brackets"):
        read(tmp_path, las(WktCoordinateSystemVlr("A[" * 1000)))
