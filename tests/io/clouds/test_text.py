"""Text as people export it: the three points of `XYZ`, or a refusal in words; never others."""

from pathlib import Path

import numpy as np
import pytest

from prunus.errors import PrunusError
from prunus.io.clouds.cloud_file import read_cloud

XYZ = np.array([[1.5, 2.5, 3.5], [4.5, 5.5, 6.5], [7.5, 8.5, 9.75]])


def rows(
    separator: str = " ",
    *further: tuple[str, ...],
    end: str = "\n",
    point: str = ".",
    first: str = "",
) -> str:
    """The points as text, with further columns behind them, or one before them."""
    text = ""
    for number, row in enumerate(XYZ.tolist()):
        words = [f"{value:g}".replace(".", point) for value in row]
        words = [*first[number : number + 1], *words, *(column[number] for column in further)]
        text += separator.join(words) + end
    return text


def read(tmp_path: Path, text: str | bytes, name: str = "tree.txt") -> np.ndarray:
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_cloud(path).xyz


READ = {
    "blanks": rows(),
    "tabs": rows("\t"),
    "commas and blanks": rows(", "),
    "bars": rows(" | "),
    "semicolons": rows(";"),
    "old Mac's line ends": rows(end="\r"),
    "Windows' line ends": rows(end="\r\n"),
    "no last line end": rows().rstrip(),
    "blank lines": rows(end="\n\n  \n"),
    "a separator at the end": rows(",", end=",\n"),
    "a table's empty rows": rows(";") + ";;\n;;\n",
    "decimal commas, semicolons": rows(";", point=","),
    "decimal commas, tabs": rows("\t", point=","),
    "decimal commas, blanks": rows(point=","),
    "numbers in quotes": rows('","').replace("\n", '"\n"').strip('"').join('""'),
    "Excel's Unicode text": ("X\tY\tZ\r\n" + rows("\t", end="\r\n")).encode("utf-16"),
    "a byte order mark": b"\xef\xbb\xbf" + ("x,y,z\n" + rows(",")).encode(),
    "a byte order mark and no names": b"\xef\xbb\xbf" + rows().encode(),
    "a remark": "# exported by hand, 2024\n" + rows(),
    "a remark with commas": "# made on 1,2,3\n" + rows(";"),
    "remarks of all kinds": "// a\n% b\n; c\n! d\n" + rows(),
    "remarks among the rows": rows(end=" # seen\n# between\n"),
    "prose of axes": "# x to the right, y up, z to you\n" + rows(),
    "an origin in a remark": "# origin: x 612000 y 5123000 z 0\n" + rows(),
    "a count": "3\n" + rows(),
    "names in a remark and a count": "//X Y Z\n3\n" + rows(),
    "several scans": "1\n1.5 2.5 3.5\n2\n4.5 5.5 6.5\n7.5 8.5 9.75\n",
    "names": "x y z\n" + rows(),
    "names in capitals and quotes": '"X";"Y";"Z"\n' + rows(";"),
    "names with blanks, data with commas": "# x y z\n" + rows(","),
    "a column before": "id,x,y,z\n" + rows(",", first="abc"),
    "the index of pandas": ",x,y,z\n" + rows(",", first="012"),
    "any order": "c,Z,Y,X\n1,3.5,2.5,1.5\n2,6.5,5.5,4.5\n3,9.75,8.5,7.5\n",
    "ParaView": '"Points:0","Points:1","Points:2","I"\n' + rows(",", ("1", "2", "3")),
    "eastings": "Northing,Easting,Elevation\n2.5,1.5,3.5\n5.5,4.5,6.5\n8.5,7.5,9.75\n",
    "positions": "pos_x\tpos_y\tpos_z\n" + rows("\t"),
    "numbers of columns": "0,1,2\n" + rows(","),
    "units apart from the names": "X [m] Y [m] Z [m]\n" + rows(),
    "Excel's word of its separator": "sep=;\nx;y;z\n" + rows(";"),
    "units behind the names": "x[m], y[m], z (m)\n" + rows(","),
    "classes in words": "x;y;z;class\n" + rows(";", ("oak", "old oak", '"a;b"')),
    "nan and nothing in other columns": "x,y,z,i\n" + rows(",", ("nan", "", "1")),
    "words behind unnamed points": rows(" ", ("oak", "oak", "elm")),
    "an empty cell in the first row": "x;y;z;class\n1.5;2.5;3.5;\n4.5;5.5;6.5;b\n7.5;8.5;9.75;\n",
    "columns in a remark": "# columns: x y z i\n" + rows(" ", ("1", "1", "2")),
}


@pytest.mark.parametrize("text", READ.values(), ids=READ.keys())
@pytest.mark.parametrize("ending", [".xyz", ".txt", ".csv", ".asc", ".pts"])
def test_the_points_come_back(tmp_path: Path, text: str | bytes, ending: str) -> None:
    assert read(tmp_path, text, f"tree{ending}").tolist() == XYZ.tolist()


REFUSED = {
    "R's names, one short": (
        '"x" "y" "z"\n' + rows(first="123"),
        "3 names .x, y, z., .* 4 columns",
    ),
    "an index without a name": (rows(first="123"), "the first of 4 columns counts the points"),
    "pandas' index without a name": (",0,1,2\n" + rows(",", first="012"), "counts the points"),
    "an index with gaps": (rows(first="379"), "counts the points"),
    "times without a name": ("1700000000.1 1.5 2.5 3.5\n" * 3, "holds 1700000000, as times are"),
    "names of something else": ("lon lat h\n" + rows(), "no column 'x' among lon, lat, h"),
    "names in another place": ("% i x y z w\n" + rows(" ", ("1", "1", "1")), "5 names .i, x, y"),
    "a name twice": ("x,y,z,x\n" + rows(",", ("1", "2", "3")), "'x' stands twice"),
    "units that differ": ("x[m],y[m],z[mm]\n" + rows(","), r"no one unit behind x\[m\]"),
    "a unit of no length": ("x[s],y[s],z[s]\n" + rows(","), r"no one unit behind x\[s\]"),
    "a title": ("Orchard 7\n" + rows(), "'Orchard 7' is neither a row of numbers, nor names"),
    "a grid": ("ncols 9\nnrows 3\ncell 1\n" + rows(), "is neither a row of numbers"),
    "a PTX": ("3\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + rows(), "promise 4 points, the file holds 7"),
    "a count that is more": ("9\n" + rows(), "truncated: .* promise 9 points, the file holds 3"),
    "a count that is less": ("2\n" + rows(), "promise 2 points, the file holds 3"),
    "decimal commas between commas": (rows(",", point=","), "may have commas within numbers"),
    "points and commas": ("1,5;2.5;3,5\n", "line 1: '1,5' is no number"),
    "thousands": ("1,234.5 2.5 3.5\n", "'1,234.5 2.5 3.5' is neither"),
    "a short row": ("1 2 3\n4 5\n", "columns changed: line 2 holds 2, line 1 3"),
    "two rows in one": ("1 2 3\n4 5 6 7 8 9\n", "columns changed: line 2 holds 6"),
    "a word": ("# a\n1 2 3\n4 five 6\n", "line 3: 'five' is no number"),
    "Visual C's NaN": (rows() + "-1.#IND 2 3\n", "line 4: '-1.#IND' is no number"),
    "numbers of Python": (rows() + "1_0 2 3\n", "line 4: '1_0' is no number"),
    "names alone": ("x,y,z\n", "'x,y,z' is neither"),
    "two columns": ("1,2\n3,4\n", "rows hold 2 numbers; expected x, y, z"),
    "whole numbers alone": ("1\n2\n3\n", "holds no points; expected rows of numbers"),
    "remarks alone": ("# a\n", "holds no points; expected rows of numbers"),
    "bytes": (b"1 2 3\n\0\1\2", "bytes that are no text"),
    "a page": ("<html>\n<p>1 2 3\n", "'<html>' is neither"),
}


@pytest.mark.parametrize(("text", "said"), REFUSED.values(), ids=REFUSED.keys())
def test_what_cannot_be_told_is_refused_in_words(
    tmp_path: Path, text: str | bytes, said: str
) -> None:
    with pytest.raises(PrunusError, match=rf"tree\.txt: .*{said}"):
        read(tmp_path, text)


BRIGHT, DIM = ("200", "9", "0"), ("1", "2", "0")


@pytest.mark.parametrize(
    ("text", "name", "column"),
    [
        (rows(" ", BRIGHT, DIM, DIM), "a.xyz", 3),
        (rows(" ", ("-7", "0.5", "1"), BRIGHT, DIM, DIM), "a.pts", 4),
        (rows(" ", BRIGHT, BRIGHT, DIM, DIM), "a.pts", 4),
        (rows(" ", ("0.5", "1", "2"), BRIGHT, DIM, DIM), "a.txt", 4),
        ("x y z i red green blue\n" + rows(" ", DIM, BRIGHT, DIM, DIM), "a.txt", 4),
        ("//X Y Z R G B\n" + rows(" ", BRIGHT, DIM, DIM), "a.asc", 3),
    ],
)
def test_colours_are_taken_where_they_are(
    tmp_path: Path, text: str, name: str, column: int
) -> None:
    (tmp_path / name).write_text(text)
    cloud = read_cloud(tmp_path / name)
    assert cloud.rgb is not None and cloud.rgb[0, 0] == 200 and cloud.rgb[1].tolist() == [9, 2, 2]
    said = [f"{column + 1} to {column + 3} as red, green, blue" in note for note in cloud.notes]
    assert said == [True] or (said == [] and text[0] in "x/")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            rows(" ", ("0.1", "0", "1"), ("0", "0", "0"), ("0.9", "1", "0")),
            "6 columns without names",
        ),
        (rows(" ", DIM, DIM, DIM), "6 columns without names"),
        (rows(" ", BRIGHT, BRIGHT, DIM, DIM), "7 columns without names"),
        (rows(" ", ("1", "2", "4")), "4 columns without names: 1 to 3 are read as x, y, z"),
        (
            "x y z r g b\n" + rows(" ", ("-1", "0", "1"), DIM, DIM),
            "no colours: r, g, b hold something",
        ),
    ],
)
def test_nothing_else_is_taken_for_colours_and_it_is_said(
    tmp_path: Path, text: str, said: str
) -> None:
    (tmp_path / "a.txt").write_text(text)
    cloud = read_cloud(tmp_path / "a.txt")
    assert cloud.rgb is None and cloud.xyz.tolist() == XYZ.tolist()
    assert said in cloud.notes[0]


def test_a_unit_behind_the_names_counts(tmp_path: Path) -> None:
    assert read(tmp_path, "x[mm];y[mm];z[mm]\n" + rows(";")) == pytest.approx(XYZ / 1000)


def test_rows_without_coordinates_are_left_out_and_said(tmp_path: Path) -> None:
    text = "x;y;z\n" + rows(";") + "4;;6\nNaN;1;2\n"
    (tmp_path / "a.csv").write_text(text)
    cloud = read_cloud(tmp_path / "a.csv")
    assert cloud.xyz.tolist() == XYZ.tolist()
    assert cloud.notes == ["2 of 5 points are not finite (NaN) and were left out"]
