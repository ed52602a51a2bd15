"""STEP (ISO 10303-21, AP214): a part as one exact solid of planes and cylinders, or all of an assembly's parts in their places.

Nothing in it is facetted: walls are planes and cylinders, edges lines and circles; a drum's walls and their edges are cubic
splines. What is read is what is written here: upright walls between level faces, and drums; every corner is held to the curves
and surfaces that meet in it, every spline's edge to the surfaces on both sides.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from camgen._version import __version__
from camgen.bounds import read_bytes
from camgen.errors import FileError
from camgen.files.formats import FORMATS, Job
from camgen.files.threemf import PartCopy
from camgen.geometry.brep import Brep, Edge, Face, Loop
from camgen.geometry.outlines import Floats
from camgen.geometry.splines import DEGREE, Patch, Spline
from camgen.numerics import magnitude
from camgen.parts.exact import SAME, exact

_SCHEMA = "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }"
_DESCRIPTION = "lengths in mm; no date of writing: the same spec gives the same bytes on any day"
_UPRIGHT = (0.0, 0.0, 1.0)
_LEVEL = (1.0, 0.0, 0.0)


def write_part(path: Path, job: Job) -> None:
    """Write the part's exact solid; DesignError where it has none."""
    assert job.part is not None, "an exact solid is asked for"
    write_step(
        path, {job.name: exact(job.part, job.tolerance)}, {job.name: job.part.title}, job.title
    )


def write_step(
    path: Path,
    bodies: Mapping[str, Brep],
    titles: Mapping[str, str],
    title: str,
    copies: Sequence[PartCopy] = (),
) -> None:
    """Write bodies by name, with titles for people: each a part by itself, or with copies all in the places of an assembly."""
    out = _Entities()
    shapes = {
        name: _product(out, name, titles.get(name, name), body) for name, body in bodies.items()
    }
    if copies:
        _assembly(out, title, shapes, copies)
    header = (
        "ISO-10303-21;\nHEADER;\n"
        f"FILE_DESCRIPTION(({_text(_DESCRIPTION)}),'2;1');\n"
        f"FILE_NAME({_text(title)},'1970-01-01T00:00:00',(''),(''),'camgen {__version__}','camgen','');\n"
        f"FILE_SCHEMA(('{_SCHEMA}'));\nENDSEC;\nDATA;\n"
    )
    path.write_text(
        header + "".join(out.lines) + "ENDSEC;\nEND-ISO-10303-21;\n", encoding="ascii", newline="\n"
    )


class _Entities:
    """Lines of the data section, after what all products share."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.known: dict[str, int] = {}
        application = self.add(
            "APPLICATION_CONTEXT('core data for automotive mechanical design processes')"
        )
        self.add(
            f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})"
        )
        self.product = self.add(f"PRODUCT_CONTEXT('',#{application},'mechanical')")
        self.definition = self.add(
            f"PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"
        )
        length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        near = self.add(
            f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({_real(SAME)}),#{length},'distance_accuracy_value','')"
        )
        self.context = self.add(
            f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{near}))"
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))REPRESENTATION_CONTEXT('',''))"
        )

    def add(self, text: str) -> int:
        """Add an entity; its number."""
        self.lines.append(f"#{len(self.lines) + 1}={text};\n")
        return len(self.lines)

    def once(self, text: str) -> int:
        """An entity that others may share."""
        if text not in self.known:
            self.known[text] = self.add(text)
        return self.known[text]

    def point(self, place: Iterable[float]) -> int:
        """A point."""
        return self.once(f"CARTESIAN_POINT('',{_row(place)})")

    def place(
        self,
        origin: Iterable[float],
        axis: Iterable[float] = _UPRIGHT,
        along: Iterable[float] = _LEVEL,
    ) -> int:
        """A frame: origin, its z axis and its x axis."""
        at = self.point(origin)
        z, x = (self.once(f"DIRECTION('',{_row(way)})") for way in (axis, along))
        return self.once(f"AXIS2_PLACEMENT_3D('',#{at},#{z},#{x})")


def _real(value: float) -> str:
    """A number as the format wants it: with a point, and all its digits."""
    mantissa, exponent, power = repr(float(value) + 0.0).upper().partition("E")
    return (mantissa if "." in mantissa else f"{mantissa}.") + exponent + power


def _row(values: Iterable[float]) -> str:
    return f"({','.join(map(_real, values))})"


def _text(text: str) -> str:
    """A string: apostrophes and backslashes doubled, what is not ASCII by its code."""
    doubled = text.replace("\\", "\\\\").replace("'", "''")
    return "'" + re.sub(r"[^ -~]", lambda found: f"\\X4\\{ord(found[0]):08X}\\X0\\", doubled) + "'"


def _refs(numbers: Iterable[int]) -> str:
    return f"({','.join(f'#{n}' for n in numbers)})"


def _defined(out: _Entities, name: str, title: str) -> int:
    """A product of this name; its definition."""
    product = out.add(f"PRODUCT({_text(name)},{_text(name)},{_text(title)},(#{out.product}))")
    out.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))")
    formation = out.add(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
    return out.add(f"PRODUCT_DEFINITION('design','',#{formation},#{out.definition})")


def _product(out: _Entities, name: str, title: str, body: Brep) -> tuple[int, int]:
    """A body as a product: its definition, and the representation of its shape."""
    definition = _defined(out, name, title)
    shape = out.add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
    solid = _solid(out, name, body)
    representation = out.add(
        f"ADVANCED_BREP_SHAPE_REPRESENTATION({_text(name)},(#{out.place((0, 0, 0))},#{solid}),#{out.context})"
    )
    out.add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})")
    return definition, representation


def _solid(out: _Entities, name: str, body: Brep) -> int:
    points = body.corners.tolist()
    corners = [out.add(f"VERTEX_POINT('',#{out.point(p)})") for p in points]
    curves = []
    for edge in body.edges:
        a = points[edge.a]
        b = points[edge.b]
        if edge.spline is not None:
            curve = _spline(out, edge.spline)
        elif edge.radius:
            curve = out.add(
                f"CIRCLE('',#{out.place((edge.centre.real, edge.centre.imag, a[2]))},{_real(edge.radius)})"
            )
        else:
            way = out.once(f"DIRECTION('',{_row(_unit(b, a))})")
            vector = out.once(f"VECTOR('',#{way},1.0)")
            curve = out.add(f"LINE('',#{out.point(a)},#{vector})")
        curves.append(out.add(f"EDGE_CURVE('',#{corners[edge.a]},#{corners[edge.b]},#{curve},.T.)"))
    faces = []
    for face in body.faces:
        bounds = []
        for k, loop in enumerate(face.loops):
            steps = [
                out.add(f"ORIENTED_EDGE('',*,*,#{curves[e]},{'.T.' if forward else '.F.'})")
                for e, forward in loop
            ]
            ring = out.add(f"EDGE_LOOP('',{_refs(steps)})")
            bounds.append(out.add(f"{'FACE_BOUND' if k else 'FACE_OUTER_BOUND'}('',#{ring},.T.)"))
        surface, same = _surface(out, body, face)
        faces.append(
            out.add(f"ADVANCED_FACE('',{_refs(bounds)},#{surface},{'.T.' if same else '.F.'})")
        )
    shell = out.add(f"CLOSED_SHELL('',{_refs(faces)})")
    return out.add(f"MANIFOLD_SOLID_BREP({_text(name)},#{shell})")


def _spline(out: _Entities, spline: Spline) -> int:
    poles = _refs(out.point(place) for place in spline.poles.tolist())
    counts, knots = _knots(spline.knots)
    return out.add(
        f"B_SPLINE_CURVE_WITH_KNOTS('',{DEGREE},{poles},.UNSPECIFIED.,.F.,.F.,{counts},{knots},.UNSPECIFIED.)"
    )


def _patch(out: _Entities, patch: Patch) -> int:
    rows = ",".join(_refs(out.point(place) for place in row) for row in patch.poles.tolist())
    (counts, knots), (across, others) = map(_knots, (patch.along, patch.across))
    return out.add(
        f"B_SPLINE_SURFACE_WITH_KNOTS('',{DEGREE},{DEGREE},({rows}),.UNSPECIFIED.,.F.,.F.,.F.,"
        f"{counts},{across},{knots},{others},.UNSPECIFIED.)"
    )


def _knots(knots: Floats) -> tuple[str, str]:
    """Multiplicities and knots."""
    places, counts = np.unique(knots, return_counts=True)
    return f"({','.join(map(str, counts.tolist()))})", _row(places.tolist())


def _unit(b: Sequence[float], a: Sequence[float]) -> list[float]:
    way = [q - p for p, q in zip(a, b, strict=True)]
    size = math.hypot(*way)
    return [w / size for w in way]


def _surface(out: _Entities, body: Brep, face: Face) -> tuple[int, bool]:
    """The surface of a face, and whether its own normal looks out of the material."""
    if face.patch is not None:
        return _patch(out, face.patch), True
    if face.radius:
        return out.add(
            f"CYLINDRICAL_SURFACE('',#{out.place((0, 0, 0))},{_real(abs(face.radius))})"
        ), face.radius > 0
    step = min(
        face.loops[0], key=lambda step: (_rise(body, step), body.corners[body.first(step), 2])
    )
    at = body.corners[body.first(step)].tolist()
    if face.looks:
        return out.add(f"PLANE('',#{out.place(at, (0, 0, face.looks))})"), True
    edge = body.edges[step[0]]
    if edge.radius:  # the lower edge: the material is on its left
        axis = out.place((edge.centre.real, edge.centre.imag, at[2]))
        return out.add(f"CYLINDRICAL_SURFACE('',#{axis},{_real(edge.radius)})"), step[1]
    x, y, _ = _unit(body.corners[body.last(step)].tolist(), at)
    return out.add(f"PLANE('',#{out.place(at, (y, -x, 0), (x, y, 0))})"), True


def _rise(body: Brep, step: tuple[int, bool]) -> bool:
    """Whether a step of a loop is upright."""
    return bool(body.corners[body.first(step), 2] != body.corners[body.last(step), 2])


def _assembly(
    out: _Entities, name: str, shapes: Mapping[str, tuple[int, int]], copies: Sequence[PartCopy]
) -> None:
    """All copies in their places, each under its own name."""
    whole = _defined(out, name, name)
    shape = out.add(f"PRODUCT_DEFINITION_SHAPE('','',#{whole})")
    origin = out.place((0, 0, 0))
    places = [out.place(m[:, 3], m[:, 2], m[:, 0]) for m in (copy.transform for copy in copies)]
    representation = out.add(
        f"SHAPE_REPRESENTATION({_text(name)},{_refs([origin, *places])},#{out.context})"
    )
    out.add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})")
    for copy, place in zip(copies, places, strict=True):
        part, body = shapes[copy.object]
        label = _text(copy.name)
        occurrence = out.add(
            f"NEXT_ASSEMBLY_USAGE_OCCURRENCE({label},{label},'',#{whole},#{part},$)"
        )
        occurrence_shape = out.add(f"PRODUCT_DEFINITION_SHAPE('','',#{occurrence})")
        transform = out.add(f"ITEM_DEFINED_TRANSFORMATION('','',#{origin},#{place})")
        relation = out.add(
            f"(REPRESENTATION_RELATIONSHIP('','',#{body},#{representation})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{transform})"
            "SHAPE_REPRESENTATION_RELATIONSHIP())"
        )
        out.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{occurrence_shape})")


# ---- read back ---------------------------------------------------------------------------------------------------------

_TOKEN = re.compile(
    r"\s*(?:(#\d+)|('(?:[^']|'')*')|(\.[A-Z_]+\.)|([-+]?\d+\.?\d*(?:E[-+]?\d+)?)|([A-Z_0-9]+)|([(),$*=;]))"
)
# Instances as they are written: s a string, n a number, f a flag, #A|B a reference to one of these, (#A..) several of them.
_WRITTEN = """
APPLICATION_CONTEXT(s)
APPLICATION_PROTOCOL_DEFINITION(s,s,n,#APPLICATION_CONTEXT)
PRODUCT_CONTEXT(s,#APPLICATION_CONTEXT,s)
PRODUCT_DEFINITION_CONTEXT(s,#APPLICATION_CONTEXT,s)
(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(f,f))
(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,f))
(NAMED_UNIT(*)SI_UNIT($,f)SOLID_ANGLE_UNIT())
UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(n),#LENGTH_UNIT,s,s)
(GEOMETRIC_REPRESENTATION_CONTEXT(n)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#UNCERTAINTY_MEASURE_WITH_UNIT))\
GLOBAL_UNIT_ASSIGNED_CONTEXT((#LENGTH_UNIT,#NAMED_UNIT,#NAMED_UNIT))REPRESENTATION_CONTEXT(s,s))
CARTESIAN_POINT(s,(n,n,n))
DIRECTION(s,(n,n,n))
AXIS2_PLACEMENT_3D(s,#CARTESIAN_POINT,#DIRECTION,#DIRECTION)
PRODUCT(s,s,s,(#PRODUCT_CONTEXT))
PRODUCT_RELATED_PRODUCT_CATEGORY(s,$,(#PRODUCT))
PRODUCT_DEFINITION_FORMATION(s,s,#PRODUCT)
PRODUCT_DEFINITION(s,s,#PRODUCT_DEFINITION_FORMATION,#PRODUCT_DEFINITION_CONTEXT)
PRODUCT_DEFINITION_SHAPE(s,s,#PRODUCT_DEFINITION|NEXT_ASSEMBLY_USAGE_OCCURRENCE)
ADVANCED_BREP_SHAPE_REPRESENTATION(s,(#AXIS2_PLACEMENT_3D|MANIFOLD_SOLID_BREP..),#GEOMETRIC_REPRESENTATION_CONTEXT)
SHAPE_REPRESENTATION(s,(#AXIS2_PLACEMENT_3D..),#GEOMETRIC_REPRESENTATION_CONTEXT)
SHAPE_DEFINITION_REPRESENTATION(#PRODUCT_DEFINITION_SHAPE,#SHAPE_REPRESENTATION|ADVANCED_BREP_SHAPE_REPRESENTATION)
MANIFOLD_SOLID_BREP(s,#CLOSED_SHELL)
CLOSED_SHELL(s,(#ADVANCED_FACE..))
ADVANCED_FACE(s,(#FACE_OUTER_BOUND|FACE_BOUND..),#PLANE|CYLINDRICAL_SURFACE|B_SPLINE_SURFACE_WITH_KNOTS,f)
FACE_OUTER_BOUND(s,#EDGE_LOOP,f)
FACE_BOUND(s,#EDGE_LOOP,f)
EDGE_LOOP(s,(#ORIENTED_EDGE..))
ORIENTED_EDGE(s,*,*,#EDGE_CURVE,f)
EDGE_CURVE(s,#VERTEX_POINT,#VERTEX_POINT,#LINE|CIRCLE|B_SPLINE_CURVE_WITH_KNOTS,f)
VERTEX_POINT(s,#CARTESIAN_POINT)
LINE(s,#CARTESIAN_POINT,#VECTOR)
VECTOR(s,#DIRECTION,n)
CIRCLE(s,#AXIS2_PLACEMENT_3D,n)
PLANE(s,#AXIS2_PLACEMENT_3D)
CYLINDRICAL_SURFACE(s,#AXIS2_PLACEMENT_3D,n)
B_SPLINE_CURVE_WITH_KNOTS(s,n,(#CARTESIAN_POINT..),f,f,f,(n..),(n..),f)
B_SPLINE_SURFACE_WITH_KNOTS(s,n,n,((#CARTESIAN_POINT..)..),f,f,f,f,(n..),(n..),(n..),(n..),f)
NEXT_ASSEMBLY_USAGE_OCCURRENCE(s,s,s,#PRODUCT_DEFINITION,#PRODUCT_DEFINITION,$)
ITEM_DEFINED_TRANSFORMATION(s,s,#AXIS2_PLACEMENT_3D,#AXIS2_PLACEMENT_3D)
(REPRESENTATION_RELATIONSHIP(s,s,#ADVANCED_BREP_SHAPE_REPRESENTATION,#SHAPE_REPRESENTATION)\
REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#ITEM_DEFINED_TRANSFORMATION)SHAPE_REPRESENTATION_RELATIONSHIP())
CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#REPRESENTATION_RELATIONSHIP,#PRODUCT_DEFINITION_SHAPE)
"""


def _pattern(form: str) -> re.Pattern[str]:
    """What matches an instance of a form, its references by the types they refer to."""
    text = re.sub(r"[()$*]", r"\\\g<0>", form)
    several = re.sub(r"#([A-Z_0-9|]+)\.\.", r"#(?:\1)(?:,#(?:\1))*", text)
    several = re.sub(r"\\\(([^\\]+)\\\)\.\.", r"\(\1\)(?:,\(\1\))*", several)
    several = several.replace("n..", "n(?:,n)*")
    return re.compile(re.sub(r"#([A-Z_0-9]+(?:\|[A-Z_0-9]+)+)", r"#(?:\1)", several))


_FORMS: dict[str, list[re.Pattern[str]]] = {}  # by the first type
for _form in _WRITTEN.split():
    _FORMS.setdefault(_form.lstrip("(").partition("(")[0], []).append(_pattern(_form))
_KINDS = {2: "s", 3: "f", 4: "n"}  # by the group of _TOKEN
_SIDES = 4  # of a face with splines for edges
_SHARES = np.linspace(0, 1, 33)  # of these edges, at which they are held to their surfaces
_END = [";", "END-ISO-10303-21;"]


def read_part(path: Path, name: str) -> tuple[Brep, list[str]]:
    """The part's solid, and what is wrong with the file as such; FileError where it cannot be read."""
    bodies, copies, remarks = read_step(path)
    if [*bodies] != [name] or copies:
        remarks = [f"holds {', '.join(bodies) or 'nothing'} instead of {name} alone", *remarks]
    return next(iter(bodies.values()), Brep(np.empty((0, 3)), (), ())), remarks


def read_step(path: Path) -> tuple[dict[str, Brep], list[PartCopy], list[str]]:
    """Bodies by the names of their products, copies in an assembly, and remarks: corners off their curves or surfaces, mm.

    FileError where it cannot be read, is cut short, or holds other things than upright walls between level faces, and drums.
    """
    text = read_bytes(path, FORMATS["step"].size).decode("latin-1")
    if not text.startswith("ISO-10303-21;") or not text.rstrip().endswith("END-ISO-10303-21;"):
        raise FileError(path, "not a STEP file, or cut short: it does not end in END-ISO-10303-21")
    try:
        bodies, copies, remarks = _read(text)
    except (
        KeyError,
        IndexError,
        ValueError,
        TypeError,
        ZeroDivisionError,
        RecursionError,
    ) as error:
        raise FileError(
            path, f"not a STEP file of upright walls between level faces, or of a drum: {error!r}"
        ) from None
    return dict(bodies), list(copies), list(remarks)


@lru_cache(maxsize=4)  # a drum's is asked for by three stages
def _read(text: str) -> tuple[dict[str, Brep], list[PartCopy], list[str]]:
    return _Reader(_entities(text)).read()


def _entities(text: str) -> dict[str, list[Any]]:
    """Entities of the data section by their number, "#1": name, arguments, name, arguments... ; names are "=NAME".

    ValueError where one is not of a form that is written here, by its number.
    """
    data = text.partition("DATA;")[2]
    entities: dict[str, list[Any]] = {}
    forms: dict[str, list[str]] = {}
    stack: list[list[Any]] = [[]]
    form: list[str] = []
    at = 0
    while (match := _TOKEN.match(data, at)) is not None and match[5] != "ENDSEC":
        at = match.end()
        ref, string, flag, number, name, mark = match.groups()
        form.append(_KINDS.get(match.lastindex or 0) or ref or name or mark)
        if ref or string or flag or mark in ("$", "*"):
            stack[-1].append(ref or (string[1:-1].replace("''", "'") if string else flag or mark))
        elif number:
            stack[-1].append(float(number))
        elif mark == "(":
            stack.append([])
        elif mark == ")":
            inner = stack.pop()
            stack[-1].append(inner)
        elif name:
            stack[-1].append(f"={name}")
        elif mark == ";":
            (row,) = stack
            key = next((each for each in form if each[0] == "#"), form[0])
            if key in entities:
                raise ValueError(f"{key} stands twice")
            entities[key] = (
                row[1] if len(row) == 2 else row[1:]
            )  # several types of one entity are in brackets of their own
            forms[key] = form
            stack = [[]]
            form = []
    if match is None or form or data[match.end() :].split() != _END:
        raise ValueError(f"no instance, and not the end: {data[at : at + 40].strip()!r}")
    _refuse_other_forms(forms)
    return entities


def _refuse_other_forms(forms: Mapping[str, Sequence[str]]) -> None:
    """Raise ValueError at an instance that is not of a form that is written here; forms: kinds of their tokens."""
    types = {
        ref: next((each for each in form[2:4] if each != "("), "") for ref, form in forms.items()
    }
    for ref, form in forms.items():
        text = "".join(f"#{types.get(each, '')}" if each[0] == "#" else each for each in form[2:-1])
        if form[:2] != [ref, "="] or not any(
            each.fullmatch(text) for each in _FORMS.get(types[ref], ())
        ):
            raise ValueError(f"{ref} is {text[:100]}, not as camgen writes it")


def _refuse_degrees(ref: str, *degrees: float) -> None:
    """Raise ValueError at a spline that is no cubic."""
    if set(degrees) != {DEGREE}:
        raise ValueError(f"{ref} is a spline of degree {degrees}, expected {DEGREE}")


def _repeated(knots: Sequence[float], counts: Sequence[float]) -> Floats:
    """Each knot as often as its multiplicity says; ValueError where that is none of a cubic."""
    if not set(counts) <= set(range(1, DEGREE + 2)):
        raise ValueError(f"multiplicities of knots are {sorted(set(counts))}")
    return np.repeat(knots, np.array(counts, int))


class _Reader:
    """Bodies and copies out of entities."""

    def __init__(self, entities: Mapping[str, list[Any]]) -> None:
        self.entities = entities
        self.worst = 0.0

    def get(self, ref: str, *names: str) -> list[Any]:
        """Arguments of an entity, which is to be of one of these types."""
        row = self.entities[ref]
        for name in names:
            if f"={name}" in row:
                return list(row[row.index(f"={name}") + 1])
        raise ValueError(f"{ref} is {row[0][1:]}, expected {' or '.join(names)}")

    def all(self, name: str) -> list[tuple[str, list[Any]]]:
        """All entities of a type."""
        return [
            (ref, self.get(ref, name)) for ref, row in self.entities.items() if f"={name}" in row
        ]

    def point(self, ref: str) -> Floats:
        """A point or a direction."""
        return np.array(self.get(ref, "CARTESIAN_POINT", "DIRECTION")[1], float)

    def frame(self, ref: str) -> tuple[Floats, Floats, Floats]:
        """Origin, z axis and x axis."""
        _, at, z, x = self.get(ref, "AXIS2_PLACEMENT_3D")
        return self.point(at), self.point(z), self.point(x)

    def read(self) -> tuple[dict[str, Brep], list[PartCopy], list[str]]:
        """Bodies, copies, remarks."""
        remarks = []
        scale = [self.get(ref, "SI_UNIT") for ref, _ in self.all("LENGTH_UNIT")]
        if scale != [[".MILLI.", ".METRE."]]:
            remarks.append(f"lengths are in {scale}, expected millimetres")
        names: dict[str, str] = {}
        for ref, args in self.all("PRODUCT_DEFINITION"):
            product = self.get(args[2], "PRODUCT_DEFINITION_FORMATION")[2]
            names[ref] = str(self.get(product, "PRODUCT")[0])
        owners = {ref: args[2] for ref, args in self.all("PRODUCT_DEFINITION_SHAPE")}
        bodies: dict[str, Brep] = {}
        for _, (shape, representation) in self.all("SHAPE_DEFINITION_REPRESENTATION"):
            if "=ADVANCED_BREP_SHAPE_REPRESENTATION" not in self.entities[representation]:
                continue
            solids = [
                item
                for item in self.get(representation, "ADVANCED_BREP_SHAPE_REPRESENTATION")[1]
                if "=MANIFOLD_SOLID_BREP" in self.entities[item]
            ]
            if len(solids) != 1:
                remarks.append(f"{len(solids)} solids of {names[owners[shape]]}")
            bodies[names[owners[shape]]] = self.body(solids[0])
        copies = []
        for _, (relation, use) in self.all("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"):
            label, _, _, _, part, _ = self.get(owners[use], "NEXT_ASSEMBLY_USAGE_OCCURRENCE")
            transform = self.get(relation, "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION")[0]
            at, z, x = self.frame(self.get(transform, "ITEM_DEFINED_TRANSFORMATION")[3])
            copies.append(
                PartCopy(names[part], str(label), np.column_stack([x, np.cross(z, x), z, at]))
            )
        if self.worst > SAME:
            remarks.append(
                f"a corner is {self.worst:.3g} mm off a line, circle or surface that ends in it"
            )
        return bodies, copies, remarks

    def body(self, ref: str) -> Brep:
        """A solid."""
        faces = self.get(self.get(ref, "MANIFOLD_SOLID_BREP")[1], "CLOSED_SHELL")[1]
        corners: dict[str, int] = {}
        points: list[Floats] = []
        edges: dict[str, int] = {}
        curves: list[Edge] = []

        def corner(vertex: str) -> int:
            if vertex not in corners:
                corners[vertex] = len(points)
                points.append(self.point(self.get(vertex, "VERTEX_POINT")[1]))
            return corners[vertex]

        def edge(curve_ref: str) -> int:
            if curve_ref not in edges:
                _, a, b, curve, sense = self.get(curve_ref, "EDGE_CURVE")
                if sense != ".T.":
                    raise ValueError(f"{curve_ref} runs against its curve")
                edges[curve_ref] = len(curves)
                curves.append(self.edge(corner(a), corner(b), points, curve))
            return edges[curve_ref]

        read: list[tuple[tuple[Loop, ...], str, bool]] = []
        for face_ref in faces:
            _, bounds, surface, sense = self.get(face_ref, "ADVANCED_FACE")
            loops: list[Loop] = []
            for bound in bounds:
                _, loop, along = self.get(bound, "FACE_OUTER_BOUND", "FACE_BOUND")
                if along != ".T.":
                    raise ValueError(f"{bound} runs against its face")
                steps = [self.get(step, "ORIENTED_EDGE") for step in self.get(loop, "EDGE_LOOP")[1]]
                loops.append(tuple((edge(step[3]), step[4] == ".T.") for step in steps))
            read.append((tuple(loops), surface, sense == ".T."))
        edged = Brep(np.array(points), curves, ())
        return Brep(edged.corners, curves, [self.face(edged, *each) for each in read])

    def edge(self, a: int, b: int, points: Sequence[Floats], curve: str) -> Edge:
        """An edge, its corners held to its curve."""
        if "=CIRCLE" in self.entities[curve]:
            _, place, radius = self.get(curve, "CIRCLE")
            at, z, _ = self.frame(place)
            if z.tolist() != [0, 0, 1]:
                raise ValueError(f"{curve} is a circle that does not lie level")
            for corner in (a, b):
                self.off(math.hypot(*(points[corner] - at)[:2]) - radius, points[corner][2] - at[2])
            return Edge(a, b, complex(at[0], at[1]), radius)
        if "=B_SPLINE_CURVE_WITH_KNOTS" in self.entities[curve]:
            _, degree, poles, *_, counts, knots, _ = self.get(curve, "B_SPLINE_CURVE_WITH_KNOTS")
            _refuse_degrees(curve, degree)
            spline = Spline(_repeated(knots, counts), self.poles(poles))
            self.off(*(spline.poles[[0, -1]] - [points[a], points[b]]).ravel())
            return Edge(a, b, spline=spline)
        _, at_ref, vector = self.get(curve, "LINE")
        way = self.point(self.get(vector, "VECTOR")[1])
        for corner in (a, b):
            self.off(*np.cross(points[corner] - self.point(at_ref), way / np.linalg.norm(way)))
        if np.dot(points[b] - points[a], way) <= 0:
            raise ValueError(f"{curve} runs the other way")
        return Edge(a, b)

    def poles(self, refs: Sequence[str]) -> Floats:
        """Points, (n, 3)."""
        return np.array([self.point(ref) for ref in refs])

    def face(self, body: Brep, loops: tuple[Loop, ...], surface: str, same: bool) -> Face:
        """A face, its loops held to its surface."""
        splines = any(body.edges[edge].spline is not None for loop in loops for edge, _ in loop)
        if not splines:
            return Face(self.looks(body, loops, surface, same), loops)
        if len(loops) != 1 or len(loops[0]) != _SIDES:
            raise ValueError(f"{surface} has splines for edges, and not {_SIDES} of them round it")
        runs = [body.along(step, _SHARES) for step in loops[0]]
        if "=B_SPLINE_SURFACE_WITH_KNOTS" in self.entities[surface]:
            if not same:
                raise ValueError(f"{surface} looks the other way")
            _, *degrees, rows, _, _, _, _, counts, across, knots, others, _ = self.get(
                surface, "B_SPLINE_SURFACE_WITH_KNOTS"
            )
            _refuse_degrees(surface, *degrees)
            patch = Patch(
                _repeated(knots, counts),
                _repeated(others, across),
                np.array([self.poles(row) for row in rows]),
            )
            bottom, right, top, left = (side(_SHARES) for side in patch.sides)
            for run, side in zip(runs, (bottom, right, top[::-1], left[::-1]), strict=True):
                self.off(float(np.max(np.linalg.norm(run - side, axis=-1))))
            return Face(0, loops, patch=patch)
        _, place, radius = self.get(surface, "CYLINDRICAL_SURFACE")
        at, z, _ = self.frame(place)
        around = np.concatenate(runs)
        self.off(magnitude(np.hypot(around[:, 0], around[:, 1]) - radius), *at[:2])
        turn = np.unwrap(np.arctan2(around[:, 1], around[:, 0]))
        height = around[:, 2]
        outwards = 1 if same else -1
        around_it = np.sum(turn * np.roll(height, -1) - np.roll(turn, -1) * height)
        if z.tolist() != [0, 0, 1] or outwards * around_it <= 0:
            raise ValueError(f"{surface} does not stand about z, or its face looks the other way")
        return Face(0, loops, outwards * radius)

    def looks(self, body: Brep, loops: Sequence[Loop], surface: str, same: bool) -> int:
        """Where a face looks, its corners held to its surface, and its loops to the side on which it has the material."""
        places = np.array([body.corners[body.first(step)] for loop in loops for step in loop])
        level = [step for step in loops[0] if not _rise(body, step)]
        if "=CYLINDRICAL_SURFACE" in self.entities[surface]:
            _, place, radius = self.get(surface, "CYLINDRICAL_SURFACE")
            at, z, _ = self.frame(place)
            lowest = min(level, key=lambda step: body.corners[body.first(step), 2])
            self.off(*(np.hypot(*(places - at)[:, :2].T) - radius))
            arc = body.edges[lowest[0]]
            self.off(abs(arc.centre - complex(at[0], at[1])), arc.radius - radius)
            if z.tolist() != [0, 0, 1] or lowest[1] != same:
                raise ValueError(
                    f"{surface} is a cylinder that does not stand upright, or its face looks the other way"
                )
            return 0
        at, z, _ = self.frame(self.get(surface, "PLANE")[1])
        z = z if same else -z
        self.off(*((places - at) @ z))
        if abs(z[2]) == 1:
            if sum(body.ring(loop).area for loop in loops) * z[2] <= 0:
                raise ValueError(f"{surface} looks the other way")
            return int(z[2])
        lowest = min(level, key=lambda step: body.corners[body.first(step), 2])
        way = body.plan[body.last(lowest)] - body.plan[body.first(lowest)]
        if z[2] != 0 or (complex(z[0], z[1]) * np.conj(-1j * way)).real <= 0:
            raise ValueError(f"{surface} is a plane that leans, or its face looks the other way")
        return 0

    def off(self, *apart: float) -> None:
        """Note distances that are to be 0, mm."""
        self.worst = max(self.worst, *(abs(float(each)) for each in apart))
