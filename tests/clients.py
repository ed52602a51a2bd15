"""Real programs open every part that specs/ produces: pytest tests/clients.py, or python tests/clients.py FOLDER...

admesh, prusa-slicer, openscad, librecad and chromium come with apt, GDAL, gmsh and OCP with `pip install pyogrio gmsh
cadquery-ocp-novtk`, lib3mf with camgen; what is not installed is passed over, and said so. Exit codes of these programs mean little, so what they print is
read: each client answers with what it has against a file, "" for nothing. Areas and volumes are compared with the exact
ones of report.json.
"""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
import zlib
from collections import ChainMap, defaultdict
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import chromium, without_webgl

from camgen.files.stl import read_stl
from camgen.geometry.mesh import slice_mesh
from camgen.parts.bench_steps import _KINDS

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENT = os.environ | {"LC_ALL": "C.UTF-8", "QT_QPA_PLATFORM": "offscreen"}
FACETS = 5e-3  # share of the volume that facets within the tolerance may cost the smallest pin
MOST_POINTS = 5000  # of a contour, so that slicers and exact kernels answer in seconds
A3 = 297.0  # mm, height of the sheet that LibreCAD prints on; its pixels are 0.06 points
PIXEL = 0.06 * 25.4 / 72

Problem = str  # what a program has against a file, "" for nothing
Client = Callable[[Path], Problem]


def said(*command: object, limit: float = 120) -> str:
    """Everything a program prints; "time limit" if it runs into that."""
    kept: dict[str, Any] = {
        "stdin": subprocess.DEVNULL,
        "stdout": subprocess.PIPE,
        "stderr": subprocess.STDOUT,
        "text": True,
    }
    try:
        return str(
            subprocess.run(
                [str(word) for word in command], env=ENVIRONMENT, timeout=limit, **kept
            ).stdout
        )
    except subprocess.TimeoutExpired:
        return "time limit"


def part_of(path: Path) -> dict[str, Any]:
    """The part in report.json that a file shows; {} for an assembly, a plate or a drawing."""
    parts = json.loads((path.parent / "report.json").read_text(encoding="utf-8"))["parts"]
    return next((part for part in parts if path.name in part["files"]), {})


def unlike(what: str, found: float, wanted: float, share: float) -> Problem:
    """The difference of an area or a volume from the wanted one, where it is over that share."""
    return (
        ""
        if abs(found - wanted) <= share * abs(wanted)
        else f"{what} {found:.6g}, not {wanted:.6g}"
    )


# ---- meshes ----------------------------------------------------------------------------------------------------------


def admesh(path: Path) -> Problem:
    """STL, topology and stored normals: no repair of any kind, one body of the right volume."""
    text = said("admesh", path)
    # "Total disconnected facets : before after" has two numbers, of which the first counts; -nan has none
    facts = dict(re.findall(r"([A-Z][\w ]+?) *: +(-?[\d.]+)", text))
    wanted = dict.fromkeys(
        [
            "Degenerate facets",
            "Edges fixed",
            "Facets removed",
            "Facets added",
            "Facets reversed",
            "Backwards edges",
            "Normals fixed",
            "Total disconnected facets",
        ],
        "0",
    )
    wanted["Number of parts"] = "1"
    wrong = [f"{key}: {facts.get(key)}" for key, value in wanted.items() if facts.get(key) != value]
    return "; ".join(wrong) or unlike(
        "volume", float(facts["Volume"]), part_of(path)["material_mm3"], FACETS
    )


def prusa_slicer(path: Path) -> Problem:
    """STL and 3MF: every body there, manifold, and nothing repaired on loading."""
    return prusa_slicers([path])[0]


def prusa_slicers(paths: Sequence[Path]) -> list[Problem]:
    """Several files of a folder at once: what is said of a body begins with its file's name."""
    text = said("prusa-slicer", "--info", *paths)
    sections = re.split(r"^\[([^/\]]+\.\w+)\]$", text, flags=re.MULTILINE)
    facts = dict.fromkeys(sections[1::2], "")
    for name, section in zip(sections[1::2], sections[2::2], strict=True):
        facts[name] += section
    repairs = "edges_fixed|facets_reversed|facets_removed|degenerate_facets|backwards_edges"
    problems = []
    for path in paths:
        of_file = facts.get(path.name, sections[0])  # what fails to load is not named
        found = re.findall(f"{repairs}|manifold = no|Loading of a model file failed", of_file)
        if not found:
            bodies, manifold = copies(path), of_file.count("manifold = yes")
            found = [] if manifold == bodies else [f"{manifold} manifold bodies of {bodies}"]
        problems.append("; ".join(found))
    return problems


def copies(path: Path) -> int:
    """How many bodies an STL or 3MF file places."""
    if path.suffix == ".stl":
        return 1
    with zipfile.ZipFile(path) as archive:
        return archive.read("3D/3dmodel.model").count(b"<item ")


def openscad(path: Path) -> Problem:
    """STL, by an exact kernel: one simple body."""
    with tempfile.TemporaryDirectory() as folder:
        scad = Path(folder, "x.scad")
        # a plain import would be handed through untouched
        cube = "translate([-5000, -5000, -5000]) cube(10000);"
        scad.write_text(
            f'intersection() {{ import("{path.resolve()}"); {cube} }}', encoding="utf-8"
        )
        text = said("openscad", "-o", scad.with_suffix(".off"), scad)
    if "ERROR" in text or not re.search(r"Simple: +yes", text):
        return next((line for line in text.splitlines() if "ERROR" in line), "not simple")
    volumes = re.search(r"Volumes: +(\d+)", text)  # that around the body counts
    return "" if volumes and volumes[1] == "2" else f"{volumes and int(volumes[1]) - 1} bodies"


def lib3mf(path: Path) -> Problem:
    """3MF, by the format's own library in strict mode: millimetre, manifold meshes that are not inside out."""
    import lib3mf

    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    try:
        reader.ReadFromFile(str(path))
    except lib3mf.ELib3MFException as error:
        return str(error)
    wrong = [reader.GetWarning(i)[1] for i in range(reader.GetWarningCount())]
    if model.GetUnit() != lib3mf.ModelUnit.MilliMeter:
        wrong.append(f"unit {model.GetUnit().name}")
    meshes, part = model.GetMeshObjects(), part_of(path)
    while meshes.MoveNext():
        mesh = meshes.GetCurrentMeshObject()
        vertices = np.array([v.Coordinates[:] for v in mesh.GetVertices()])
        a, b, c = (vertices[[t.Indices[i] for t in mesh.GetTriangleIndices()]] for i in range(3))
        volume = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
        if not mesh.IsManifoldAndOriented():
            wrong.append(f"{mesh.GetName()} is not manifold and oriented")
        elif volume <= 0:
            wrong.append(f"{mesh.GetName()} is inside out")
        elif part:
            wrong.append(
                unlike(f"volume of {mesh.GetName()}", volume, part["material_mm3"], FACETS)
            )
    return "; ".join(filter(None, wrong))


# ---- drawings --------------------------------------------------------------------------------------------------------


def librecad(path: Path) -> Problem:
    """DXF: a PDF comes out, and of a part the contours in it bound the right area."""
    part, scale = part_of(path), 1
    if part:
        x, y = extents(path)
        scale = max(
            int(0.9 * A3 / max(abs(x), abs(y), 1.0) / 2), 1
        )  # the sheet is centred on what is drawn
    with tempfile.TemporaryDirectory() as folder:
        said("librecad", "dxf2pdf", "-c", "-s", scale, "-t", folder, path, limit=20)
        pdf = Path(folder, f"{path.stem}.pdf")
        if not pdf.exists() or pdf.stat().st_size < 1000:
            return "no PDF came out"
        areas = sorted((bounded(ring) * (PIXEL / scale) ** 2 for ring in drawn(pdf)), reverse=True)
    if not part:
        return ""
    if not areas:
        return "nothing is drawn"
    # polylines are printed to whole pixels: half a pixel along a contour of three times the part's size
    return unlike(
        "area",
        areas[0] - sum(areas[1:]),
        part["area_mm2"],
        1e-3 + 3 * PIXEL / scale * max(x, y) / part["area_mm2"],
    )


def extents(path: Path) -> tuple[float, float]:
    """Width and height of what a DXF file says that it shows, mm."""
    corner = r"\$EXT{}\s+10\s+(\S+)\s+20\s+(\S+)"
    text = path.read_text(encoding="utf-8")
    low, high = (re.search(corner.format(which), text) for which in ("MIN", "MAX"))
    assert low and high, path
    return float(high[1]) - float(low[1]), float(high[2]) - float(low[2])


def drawn(pdf: Path) -> list[np.ndarray]:
    """Lines drawn in LibreCAD's PDF, (n,) complex pixels each: its pieces, joined where one begins at the end of another."""
    streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf.read_bytes(), re.DOTALL)
    text = ""
    for stream in streams:
        try:
            text += (
                zlib.decompressobj().decompress(stream).decode("latin1")
            )  # its last byte may look like a line's end
        except zlib.error:
            continue  # a font
    pieces: list[list[complex]] = []
    for numbers, command in re.findall(
        r"^([-\d. ]+) ([mlc])$", text.split("W* n")[-1], re.MULTILINE
    ):
        row = np.array(numbers.split(), float)
        z = row[::2] + 1j * row[1::2]
        if command == "m":
            pieces.append([z[0]])
        elif command == "l":
            pieces[-1].append(z[0])
        else:
            s, start = np.arange(1, 65) / 64, pieces[-1][-1]
            curve = (
                start * (1 - s) ** 3
                + 3 * z[0] * s * (1 - s) ** 2
                + 3 * z[1] * s**2 * (1 - s)
                + z[2] * s**3
            )
            pieces[-1] += curve.tolist()
    joined: list[list[complex]] = []
    for piece in pieces:
        last, near = joined[-1] if joined else [complex(math.inf)], 3.0  # pixels
        if abs(last[0] - last[-1]) <= near:  # closed
            joined.append(piece)
        elif abs(last[-1] - piece[0]) <= near:
            last += piece
        elif abs(last[-1] - piece[-1]) <= near:
            last += piece[::-1]
        elif abs(last[0] - piece[0]) <= near or abs(last[0] - piece[-1]) <= near:
            last.reverse()
            last += piece if abs(last[-1] - piece[0]) <= near else piece[::-1]
        else:
            joined.append(piece)
    return [np.array(piece) for piece in joined]


def bounded(ring: np.ndarray) -> float:
    """Area within a closed polygon, 0 for a line that does not close."""
    return (
        abs(float(np.imag(np.conj(ring) * np.roll(ring, -1)).sum())) / 2
        if abs(ring[0] - ring[-1]) <= 3
        else 0.0
    )


def gdal(path: Path) -> Problem:
    """DXF, a cut shop's view: layers, closed contours that do not cross themselves, the right area."""
    import pyogrio
    import shapely

    pyogrio.set_gdal_config_options({"OGR_ARC_STEPSIZE": "0.1"})
    meta, _, shapes, columns = pyogrio.raw.read(path)
    layers = columns[list(meta["fields"]).index("Layer")]
    contours = [
        shapely.from_wkb(shape)
        for shape, layer in zip(shapes, layers, strict=True)
        if layer == "CUT"
    ]
    developed = path.stem.endswith("-developed")
    told = {"PATH", "PITCH", "SCALE"} if developed else set()  # nobody cuts a drum from it
    wrong = [f"layer {layer}" for layer in sorted(set(layers) - {"CUT", *told})]
    wrong += ["an open contour" for contour in contours if not contour.is_closed]
    wrong += [
        "a contour that crosses itself"
        for contour in contours
        if contour.is_closed and not contour.is_simple
    ]
    if wrong or not contours:
        return "; ".join(wrong) or "no contour"
    if developed:  # Pappus: a groove's area is the length of its middle by its width; a drum's curvature is within the share
        (pitch,) = [shapely.from_wkb(shape) for shape in shapes[layers == "PITCH"]]
        wide, middle = ((box[2] - box[0]) for box in (contours[0].bounds, pitch.bounds))
        groove = pitch.length * (wide - middle)
        return unlike("area", shapely.Polygon(contours[0]).area, groove, 1e-3)
    areas = sorted((shapely.Polygon(contour).area for contour in contours), reverse=True)
    return unlike("area", areas[0] - sum(areas[1:]), part_of(path)["area_mm2"], 1e-4)


# ---- exact solids ----------------------------------------------------------------------------------------------------

GMSH = """
import json, sys, gmsh
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMin", 5)
for path in sys.argv[1:]:
    gmsh.clear()
    gmsh.logger.start()
    gmsh.model.occ.importShapes(path)
    gmsh.model.occ.synchronize()
    solids = [tag for _, tag in gmsh.model.getEntities(3)]
    names = [gmsh.model.getEntityName(3, tag).rpartition("/")[2] for tag in solids]
    gmsh.model.mesh.generate(2)
    wrong = [line for line in gmsh.logger.get() if line.startswith(("Error", "Warning"))]
    loose = [tag for _, tag in gmsh.model.getEntities(2) if not len(gmsh.model.getAdjacencies(2, tag)[0])]
    volume = sum(gmsh.model.occ.getMass(3, tag) for tag in solids)
    print("GMSH", json.dumps([volume, names, wrong, len(loose)]), flush=True)
    gmsh.logger.stop()
"""


def gmsh(path: Path) -> Problem:
    """STEP: its kernel finds valid solids under their names, the right volume, and meshes every face."""
    return gmshs([path])[0]


def gmshs(paths: Sequence[Path]) -> list[Problem]:
    """Several files by one process, which takes longer to start than to open one."""
    return by_one_process(GMSH, "GMSH", gmsh_problem, paths)


def by_one_process(
    script: str, mark: str, problem: Callable[[Path, Any], Problem], paths: Sequence[Path]
) -> list[Problem]:
    """What a script prints of each file, in a line of JSON after a mark; after a crash none is accepted."""
    text = said(sys.executable, "-c", script, *paths, limit=600)
    lines = re.findall(rf"^{mark} (.*)$", text, re.MULTILINE)
    facts = [json.loads(line) for line in lines]
    crashed = [text.strip()[-200:] or "crashed"] * (len(paths) - len(facts))
    return [problem(*each) for each in zip(paths, facts, strict=False)] + crashed


def gmsh_problem(path: Path, facts: tuple[float, list[str], list[str], int]) -> Problem:
    volume, names, wrong, loose = facts
    if wrong or loose or not names:
        return "; ".join(wrong) or f"{loose} faces of no solid, {len(names)} solids"
    part = part_of(path)
    if not part:
        return ""
    if names != [part["name"]]:
        return f"holds {names}"
    return unlike("volume", volume, part["material_mm3"], 1e-4)


OCP = """
import json, sys
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRep import BRep_Tool
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer

def pieces(shape, kind, beside=None):
    found, each = [], TopExp_Explorer(shape, kind) if beside is None else TopExp_Explorer(shape, kind, beside)
    while each.More():
        found.append(each.Current())
        each.Next()
    return found

for path in sys.argv[1:]:
    reader = STEPControl_Reader()
    wrong = [] if reader.ReadFile(path) == IFSelect_RetDone else ["cannot be read"]
    reader.TransferRoots()
    whole, volume = reader.OneShape(), 0.0
    solids = [] if whole.IsNull() else pieces(whole, TopAbs_SOLID)
    for solid in solids:
        wrong += [] if BRepCheck_Analyzer(solid).IsValid() else ["a solid that is not valid"]
        wrong += ["an open shell" for shell in pieces(solid, TopAbs_SHELL) if not BRep_Tool.IsClosed_s(shell)]
        mass = GProp_GProps()
        BRepGProp.VolumeProperties_s(solid, mass, 1e-9)
        volume += mass.Mass()
    loose = [] if whole.IsNull() else pieces(whole, TopAbs_FACE, TopAbs_SOLID)
    print("\\nOCP " + json.dumps([volume, len(solids), wrong, len(loose)]), flush=True)
"""


def ocp(path: Path) -> Problem:
    """STEP: OpenCASCADE finds closed, valid solids, no face besides, and the right volume."""
    return ocps([path])[0]


def ocps(paths: Sequence[Path]) -> list[Problem]:
    """Several files by one process."""
    return by_one_process(OCP, "OCP", ocp_problem, paths)


def ocp_problem(path: Path, facts: tuple[float, int, list[str], int]) -> Problem:
    volume, count, wrong, loose = facts
    if wrong or loose or not count:
        return "; ".join(wrong) or f"{loose} faces of no solid, {count} solids"
    part = part_of(path)
    if not part:
        return ""
    return (
        f"holds {count} solids"
        if count > 1
        else unlike("volume", volume, part["material_mm3"], 1e-4)
    )


# ---- every part ------------------------------------------------------------------------------------------------------

CLIENTS: dict[str, Sequence[Client]] = {
    ".stl": (admesh, prusa_slicer, openscad),
    ".3mf": (lib3mf, prusa_slicer),
    ".dxf": (librecad, gdal),
    ".step": (gmsh, ocp),
    ".html": (chromium,),
}
PACKAGES = {
    lib3mf: "lib3mf",
    gdal: "pyogrio",
    gmsh: "gmsh",
    ocp: "OCP",
}  # of Python; the others are programs
# those that take as long to start as to open some ten files: they are given all of a folder at once
AT_ONCE: dict[Client, Callable[[Sequence[Path]], list[Problem]]] = {
    gmsh: gmshs,
    ocp: ocps,
    prusa_slicer: prusa_slicers,
}


def installed(client: Client) -> bool:
    if client in PACKAGES:
        return find_spec(PACKAGES[client]) is not None
    return shutil.which(client.__name__.replace("_", "-")) is not None


def tasks(folders: Sequence[Path]) -> list[tuple[Path, Client]]:
    """All files with the clients that open them; a dimensioned sheet is for LibreCAD alone."""
    files = sorted(path for folder in folders for path in folder.rglob("*"))
    return [
        (path, client)
        for path in files
        for client in CLIENTS.get(path.suffix, ())
        if client is not gdal or not path.stem.endswith("-drawing")
    ]


def answers(work: Sequence[tuple[Path, Client]]) -> list[Problem]:
    """What each client has against its file, on all cores."""
    shares = defaultdict[tuple[Client, Path], list[Path]](list)
    for path, client in work:
        shares[client, path.parent if client in AT_ONCE else path].append(path)

    def ask(share: tuple[tuple[Client, Path], list[Path]]) -> dict[tuple[Path, Client], Problem]:
        (client, _), paths = share
        problems = AT_ONCE[client](paths) if client in AT_ONCE else map(client, paths)
        return {(path, client): problem for path, problem in zip(paths, problems, strict=True)}

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = ChainMap(*pool.map(ask, shares.items()))
    return [found[each] for each in work]


@pytest.fixture(scope="module")
def folder_of(once: Callable[[str, Callable[[Path], None]], Path]) -> Callable[[str], Path]:
    """folder_of("linkage"): what the command builds of specs/linkage.toml, once, to be read."""

    def folder(name: str) -> Path:
        def make(out: Path) -> None:
            spec = ROOT / "specs" / f"{name}.toml"
            more = ("-o", out, "--only", "dxf,stl,3mf,step,report", "--jobs", 1)
            print(said(sys.executable, ROOT / "tests" / "flat.py", "build", spec, *more, limit=600))
            assert (out / name / "report.json").exists(), name

        return once(f"parts-of-{name}", make) / name

    return folder


@pytest.fixture(scope="module")
def built(
    folder_of: Callable[[str], Path], share_of: Callable[[Sequence[str]], Sequence[str]]
) -> list[Path]:
    """The folders of the share's specs."""
    the_others_parts = {
        "stitch-head",
        "walking-leg",
        "two-leg-walker",
        "four-leg-walker",
    }  # links of a linkage are plates
    specs = {path.stem for path in (ROOT / "specs").glob("*.toml")}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(folder_of, share_of(sorted(specs - the_others_parts))))


def needed(client: Client) -> None:
    if not installed(client):
        pytest.skip(f"{client.__name__} is not installed")


EVERY = sorted(
    {client for clients in CLIENTS.values() for client in clients},
    key=lambda client: client.__name__,
)


@pytest.mark.parametrize("client", EVERY, ids=lambda client: client.__name__)
def test_every_part_is_accepted(client: Client, built: list[Path]) -> None:
    needed(client)
    work = [each for each in tasks(built) if each[1] is client]
    # each spec has files of all kinds, but drums nothing to cut from sheet
    drums = {"cylinder-cam", "drum"}
    judged = {folder for folder in built if client is not gdal or folder.name not in drums}
    assert {path.parent for path, _ in work} == judged
    refused = {
        f"{path.parent.name}/{path.name}": problem
        for (path, _), problem in zip(work, answers(work), strict=True)
        if problem
    }
    assert refused == {}


def test_contours_have_few_points(built: list[Path]) -> None:
    for path in (path for folder in built for path in folder.glob("*.stl")):
        mesh = read_stl(path)
        heights = np.unique(np.round(mesh.vertices[:, 2], 6))
        widest = np.argsort(np.diff(heights))[-3:]
        for z in (heights[:-1] + heights[1:])[widest] / 2:
            assert all(len(ring.points) <= MOST_POINTS for ring in slice_mesh(mesh, float(z))), (
                path.name
            )


@pytest.mark.long
def test_a_sliced_cam_moves_its_follower_as_its_mesh_does(
    folder_of: Callable[[str], Path], tmp_path: Path
) -> None:
    """Real G-code: with classic perimeters within 0.002 deg of the STL for 99 % of the turn, and worse with the variable ones."""
    needed(prusa_slicer)
    from camgen.judge.follower_table import read_follower
    from camgen.measuring.motion import recover
    from camgen.measuring.outlines import read_outline

    stl = folder_of("uniform-swing") / "uniform-swing-cam.stl"
    follower = read_follower("oscillating,pivot=60/0,arm=67.082,at_deg=-153.435,radius=3")
    wanted = recover(read_outline(stl).ring, follower).s  # type: ignore[arg-type]
    off = {}
    for generator in ("classic", "arachne"):
        path = tmp_path / f"{generator}.gcode"
        said(
            "prusa-slicer",
            "--export-gcode",
            "--layer-height",
            0.2,
            "--nozzle-diameter",
            0.4,
            "--perimeter-generator",
            generator,
            *(("--resolution", 0, "--gcode-resolution", 0) if generator == "classic" else ()),
            "--center",
            "100,100",
            "-o",
            path,
            stl,
        )
        moved = recover(read_outline(path).ring, follower).s  # type: ignore[arg-type]
        off[generator] = float(np.degrees(np.quantile(np.abs(moved - wanted), 0.99)))
    assert off["classic"] < 0.002 < off["arachne"] < 0.03


@pytest.mark.long
def test_the_plate_of_a_linkage_sliced(folder_of: Callable[[str], Path], tmp_path: Path) -> None:
    """All parts are found where the slicer puts them; classic walls bear every finding, variable ones make holes tight."""
    needed(prusa_slicer)
    from camgen.pipeline.sliced import check_gcode

    folder = folder_of("linkage")
    path = tmp_path / "plate.gcode"
    for generator, wrong in (("classic", set()), ("arachne", {"PIN_GAP"})):
        layers = ("--layer-height", 0.4, "--first-layer-height", 0.4)  # half as many
        said(
            "prusa-slicer",
            "--export-gcode",
            *layers,
            "--nozzle-diameter",
            0.4,
            "--perimeter-generator",
            generator,
            *(("--resolution", 0, "--gcode-resolution", 0) if generator == "classic" else ()),
            "-o",
            path,
            folder / "linkage-plate.3mf",
        )
        report = check_gcode(folder, [path])
        assert {finding.code for finding in report.findings if not finding.ok} == wrong
        found = {row[0] for row in report.tables[0].rows}
        assert {"ground", "crank", "coupler", "rocker", "collar", "pin-1", "pin-2"} <= found


@pytest.mark.long
def test_a_cam_with_a_hub_and_a_keyway_sliced(
    folder_of: Callable[[str], Path], tmp_path: Path
) -> None:
    """Layers of the hub drive nothing, corners of the keyway that the nozzle rounds do not move the bore."""
    needed(prusa_slicer)
    from camgen.pipeline.sliced import check_gcode

    folder, path = folder_of("disc-cam"), tmp_path / "plate.gcode"
    said(
        "prusa-slicer",
        "--export-gcode",
        "--layer-height",
        0.2,
        "--nozzle-diameter",
        0.4,
        "--perimeter-generator",
        "classic",
        "--resolution",
        0,
        "--gcode-resolution",
        0,
        "-o",
        path,
        folder / "disc-cam-plate.3mf",
    )
    report = check_gcode(folder, [path])
    assert report.ok and report.numbers["motion_error_worst_layer_mm"] < 0.003


# ---- sheets for a laser ----------------------------------------------------------------------------------------------

# Areas, mm^2, within all shapes of an SVG as the browser lays them out, 96 pixels to the inch, and how many stand out of it.
SHAPES = """[...document.querySelectorAll("circle,path")].map(shape => {
  const long = shape.getTotalLength(), at = shape.getScreenCTM(), count = 1440, points = [];
  for (let k = 0; k < count; k++) points.push(shape.getPointAtLength(long * k / count).matrixTransform(at));
  return points.reduce((sum, a, k) => { const b = points[(k + 1) % count]; return sum + a.x * b.y - a.y * b.x }, 0) / 2;
}).map(area => Math.abs(area) * (25.4 / 96) ** 2)"""


def sheet_svg(path: Path) -> Problem:
    """A sheet's SVG in a browser against its DXF in GDAL: contour by contour the same area, in millimetres."""
    import pyogrio
    import shapely
    from browser import tab

    pyogrio.set_gdal_config_options({"OGR_ARC_STEPSIZE": "0.1"})
    shapes = [shapely.from_wkb(shape) for shape in pyogrio.raw.read(path.with_suffix(".dxf"))[2]]
    with tab() as page:
        page.show(path, 1200)
        seen = np.sort(page.run(SHAPES))
    wanted = np.sort([shapely.Polygon(shape).area for shape in shapes])
    if len(seen) != len(wanted):
        return f"{len(seen)} shapes, the DXF has {len(wanted)}"
    off = float(np.max(np.abs(seen / wanted - 1)))
    return "" if off < 2e-3 else f"an area is {off:.2%} off"


@pytest.mark.long
def test_a_sheet_is_the_same_in_other_programs(tmp_path: Path) -> None:
    """Inkscape's 99 MB and more are not needed for it: a browser draws the SVG, GDAL reads the DXF; damage is seen."""
    for client in (chromium, gdal):
        needed(client)
    spec = ROOT / "specs" / "linkage.toml"
    said(
        sys.executable,
        ROOT / "tests" / "flat.py",
        "build",
        spec,
        "-o",
        tmp_path,
        "--only",
        "dxf",
        "--set",
        "laser.thickness=4",
        limit=600,
    )
    path = tmp_path / "linkage" / "linkage-sheet-1.svg"
    assert sheet_svg(path) == ""
    text = path.read_text(encoding="utf-8")
    damages = {
        'viewBox="0 0 600 400"': 'viewBox="0 0 610 400"',
        'width="600mm"': 'width="600"',
        re.search("<circle.*/>\n", text)[0]: "",
        " 0 0 0 ": " 0 0 1 ",  # type: ignore[index]
    }
    for whole, broken in damages.items():
        path.write_text(text.replace(whole, broken, 1), encoding="utf-8")
        assert sheet_svg(path), whole


DRAGS = """(() => {
  %s
  const { sheet, chain, drags } = %s;
  return drags.map(asked => motion(chain, moved(asked, sheet)));
})()"""


def page_off_camgen(script: str, name: str) -> float:
    """How far the places that the page computes while points are dragged are from camgen's, mm; inf where it differs in what closes."""
    from browser import tab

    from camgen import starters
    from camgen.live.board import Board

    board = Board(next(starters.folder().rglob(f"{name}.toml")), Path("out"))
    sheet = json.loads(board.page().split('id="data">')[1].split("</script>")[0])
    points = sheet["sheet"]["points"].items()
    drags = [
        {"op": "move", "points": {point: [x + 1, y - 3]}, "follow": follow}
        for point, (x, y) in points
        for follow in (False, True)
    ]
    with tab() as page:
        asked = {"sheet": sheet["sheet"], "chain": sheet["chain"], "drags": drags}
        answers = page.run(DRAGS % (script, json.dumps(asked)))
    worst = 0.0
    for drag, answer in zip(drags, answers, strict=True):
        wanted = board.draw(drag | {"try": True})
        if wanted["start"] is None:
            continue
        if answer["start"] is None or answer["reason"] != wanted["reason"]:
            return np.inf
        for point, path in wanted["paths"].items():
            off = np.abs(np.array(path, float) - np.array(answer["paths"][point], float))
            gaps = [x is None for x in path] != [x is None for x in answer["paths"][point]]
            worst = np.inf if gaps else max(worst, float(np.nanmax(off)))
    return worst


@pytest.mark.parametrize("name", ["walking-leg", "beak"])
def test_the_page_places_a_dragged_linkage_as_camgen_does(name: str) -> None:
    """camgen answers in thousandths of a millimetre; the other side of a triangle is seen."""
    needed(chromium)
    script = (ROOT / "camgen" / "live" / "apexes.js").read_text(encoding="utf-8")
    assert page_off_camgen(script, name) < 6e-4
    assert page_off_camgen(script.replace("? -1 : 1", "? 1 : -1"), name) > 1


NAMES = """(async () => {
  const wait = ms => new Promise(done => setTimeout(done, ms));
  for (let k = 0; k < 600 && !(window.camgen && camgen.solid); k++) await wait(20);
  const card = [...document.querySelectorAll(".steps .cards li")].findIndex(each => each.textContent.includes("together on the bench"));
  location.hash = "#step=" + (card + 1);
  const bench = document.getElementById("bench");
  bench.scrollIntoView();
  for (let k = 0; k < 600 && !document.querySelector("#marks .name"); k++) await wait(20);
  await wait(2000);
  const frame = bench.getBoundingClientRect();
  return [...document.querySelectorAll("#marks .name")].map(mark => {
    const { top, bottom } = mark.getBoundingClientRect();
    return [mark.textContent, top > frame.top && bottom < frame.bottom];
  });
})()"""


def test_names_of_what_is_put_together_are_in_the_picture(tmp_path: Path) -> None:
    """Each lies below what it names: that of the lowest part too."""
    needed(chromium)
    from browser import tab

    spec = ROOT / "specs" / "four-leg-walker.toml"
    script = ROOT / "tests" / "flat.py"
    said(sys.executable, script, "build", spec, "-o", tmp_path, "--only", "3mf,report", limit=600)
    with tab() as page:
        page.show(next(tmp_path.rglob("report.html")), 1200, 900)
        names = page.run(NAMES)
    assert len(names) == _KINDS and all(inside for _, inside in names), names


def test_a_browser_without_webgl_shows_pictures_of_steps(tmp_path: Path) -> None:
    """It says what is missing; a page whose painter draws nothing is seen."""
    needed(chromium)
    spec = ROOT / "specs" / "gallery" / "four-bar.toml"
    flat = ROOT / "tests" / "flat.py"
    said(sys.executable, flat, "build", spec, "-o", tmp_path, "--only", "3mf,report", limit=600)
    page = tmp_path / "four-bar" / "report.html"
    assert without_webgl(page) == ""
    edited_text(page, "all.sort((a, b)", "[].sort((a, b)")
    assert "pixels drawn" in without_webgl(page)


# ---- each client is seen to fail -------------------------------------------------------------------------------------

TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def edited_stl(path: Path, edit: Callable[[np.ndarray], np.ndarray]) -> None:
    data = path.read_bytes()
    triangles = edit(np.frombuffer(data[84:], TRIANGLE).copy())
    path.write_bytes(data[:80] + np.uint32(len(triangles)).tobytes() + triangles.tobytes())


def flipped(triangles: np.ndarray) -> np.ndarray:
    triangles["corners"][5] = triangles["corners"][5][::-1]
    triangles["normal"][5] *= -1
    return triangles


def cracked(triangles: np.ndarray) -> np.ndarray:
    triangles["corners"][5, 0, 0] += 1e-3
    return triangles


def without_normals(triangles: np.ndarray) -> np.ndarray:
    triangles["normal"] = 0
    return triangles


def larger(triangles: np.ndarray) -> np.ndarray:
    triangles["corners"] *= 1.01
    return triangles


def doubled(triangles: np.ndarray) -> np.ndarray:
    """A second body that overlaps the first."""
    copy = triangles.copy()
    copy["corners"] += np.array([1.0, 1.5, 0.5], np.float32)
    return np.concatenate([triangles, copy])


def edited_3mf(path: Path, old: str, new: str) -> None:
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    name = next(name for name in members if name.endswith(".model"))
    text = members[name].decode()
    changed = re.sub(old, new, text, count=0 if new.startswith(r"\1") else 1)
    assert changed != text
    members[name] = changed.encode()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in members.items():
            archive.writestr(name, data)


def edited_dxf(path: Path, edit: Callable[[Any, Any], None]) -> None:
    """Change a drawing and its outer contour."""
    import ezdxf

    drawing = ezdxf.filemanagement.readfile(path)
    edit(drawing, max(drawing.modelspace().query("LWPOLYLINE[layer=='CUT']"), key=len))
    drawing.saveas(path)


def edited_text(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def in_inches(drawing: Any, contour: Any) -> None:
    drawing.header["$INSUNITS"] = 1


def unclosed(drawing: Any, contour: Any) -> None:
    contour.close(False)


def gapped(drawing: Any, contour: Any) -> None:
    contour.append(contour[0] + np.array([0.05, 0, 0, 0, 0]))
    contour.close(False)


def crossing(drawing: Any, contour: Any) -> None:
    points = list(contour)
    points[3], points[4] = points[4], points[3]
    contour.set_points(points)


def on_another_layer(drawing: Any, contour: Any) -> None:
    contour.dxf.layer = "NOTES"


def truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


INSIDE_OUT = (r'(<triangle v1="\d+") v2="(\d+)" v3="(\d+)"', r'\1 v2="\3" v3="\2"')
# a tetrahedron that no item places
UNPLACED = (
    "</resources>",
    '<object id="77"><mesh><vertices>'
    + "".join(
        f'<vertex x="{x}" y="{y}" z="{z}"/>'
        for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    )
    + "</vertices><triangles>"
    + "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}"/>'
        for a, b, c in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
    )
    + "</triangles></mesh></object></resources>",
)


def edited_step(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="ascii")
    changed = re.sub(old, new, text, count=1)
    assert changed != text
    path.write_text(changed, encoding="ascii")


A_HOLE = (r'<triangle v1="\d+" v2="\d+" v3="\d+" ?/>', "")
DAMAGES: list[tuple[Client, str, Callable[[Path], None]]] = [
    (admesh, "hole", lambda path: edited_stl(path, lambda t: t[1:])),
    (admesh, "flipped", lambda path: edited_stl(path, flipped)),
    (admesh, "crack", lambda path: edited_stl(path, cracked)),
    (admesh, "normals", lambda path: edited_stl(path, without_normals)),
    (admesh, "larger", lambda path: edited_stl(path, larger)),
    (admesh, "two bodies", lambda path: edited_stl(path, doubled)),
    (admesh, "truncated", truncated),
    (prusa_slicer, "hole", lambda path: edited_stl(path, lambda t: t[1:])),
    (prusa_slicer, "flipped", lambda path: edited_stl(path, flipped)),
    (openscad, "hole", lambda path: edited_stl(path, lambda t: t[1:])),
    (openscad, "flipped", lambda path: edited_stl(path, flipped)),
    (openscad, "overlap", lambda path: edited_stl(path, doubled)),
    (lib3mf, "hole", lambda path: edited_3mf(path, *A_HOLE)),
    (lib3mf, "inside out", lambda path: edited_3mf(path, *INSIDE_OUT)),
    (lib3mf, "inches", lambda path: edited_3mf(path, 'unit="millimeter"', 'unit="inch"')),
    (lib3mf, "truncated", truncated),
    (prusa_slicer, "hole 3mf", lambda path: edited_3mf(path, *A_HOLE)),
    (prusa_slicer, "unplaced 3mf", lambda path: edited_3mf(path, *UNPLACED)),
    (prusa_slicer, "truncated 3mf", truncated),
    (librecad, "inches", lambda path: edited_dxf(path, in_inches)),
    (librecad, "open", lambda path: edited_dxf(path, unclosed)),
    (librecad, "truncated", truncated),
    (chromium, "torn", lambda path: edited_text(path, 'id="glb">', 'id="glb">!')),
    (
        chromium,
        "wide",
        lambda path: edited_text(path, "<main>", '<main><p style="width:2000px">wide</p>'),
    ),
    (
        chromium,
        "faulty",
        lambda path: edited_text(path, "</body>", "<script>nothing.here()</script></body>"),
    ),
    (chromium, "too near", lambda path: edited_text(path, "fill = 0.94", "fill = 1.6")),
    (
        chromium,
        "part cut off",
        lambda path: edited_text(path, "look(view, reach,", "look(view, reach.slice(0, 2),"),
    ),
    (
        chromium,
        "greedy wheel",
        lambda path: edited_text(path, "if (!focused()) event", "if (false) event"),
    ),
    (gmsh, "face lost", lambda path: edited_step(path, r"(CLOSED_SHELL\('',\()#\d+,", r"\1")),
    (gmsh, "metres", lambda path: edited_step(path, r"SI_UNIT\(.MILLI.", "SI_UNIT($")),
    (
        gmsh,
        "renamed",
        lambda path: edited_step(path, r"PRODUCT\('cam','cam'", "PRODUCT('rod','rod'"),
    ),
    (gmsh, "thicker", lambda path: edited_step(path, r",12\.0\)", ",12.5)")),
    (gmsh, "truncated", truncated),
    (ocp, "face lost", lambda path: edited_step(path, r"(CLOSED_SHELL\('',\()#\d+,", r"\1")),
    (ocp, "metres", lambda path: edited_step(path, r"SI_UNIT\(.MILLI.", "SI_UNIT($")),
    (ocp, "thicker", lambda path: edited_step(path, r",12\.0\)", ",12.5)")),
    (ocp, "truncated", truncated),
    (gdal, "open", lambda path: edited_dxf(path, unclosed)),
    (gdal, "gap", lambda path: edited_dxf(path, gapped)),
    (gdal, "crossing", lambda path: edited_dxf(path, crossing)),
    (gdal, "layer", lambda path: edited_dxf(path, on_another_layer)),
]


@cache
def as_built(client: Client, path: Path) -> Problem:
    """What a client has against a sound file, asked once."""
    return client(path)


@pytest.mark.parametrize(
    ("client", "damage", "edit"), DAMAGES, ids=[f"{c.__name__} {name}" for c, name, _ in DAMAGES]
)
def test_a_damaged_file_is_refused(
    client: Client,
    damage: str,
    edit: Callable[[Path], None],
    folder_of: Callable[[str], Path],
    tmp_path: Path,
) -> None:
    needed(client)
    suffix = (
        ".3mf"
        if damage.endswith("3mf")
        else next(suffix for suffix, found in CLIENTS.items() if client in found)
    )
    name = "report.html" if client is chromium else f"disc-cam-cam{suffix}"
    source = folder_of("disc-cam") / name
    for path in (source, source.with_name("report.json")):
        shutil.copy(path, tmp_path)
    path = tmp_path / source.name
    assert as_built(client, source) == ""
    edit(path)
    assert client(path) != ""


def main(folders: Sequence[str]) -> int:
    """Print a line for each file and program; 1 if any refuses a file."""
    work = tasks([Path(folder) for folder in folders])
    able = [each for each in work if installed(each[1])]
    found = dict(zip(able, answers(able), strict=True))
    for path, client in work:
        problem = found.get((path, client), "not installed")
        print(f"{path.name:44} {client.__name__:14} {problem or 'ok'}")
    return 1 if any(found.values()) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
