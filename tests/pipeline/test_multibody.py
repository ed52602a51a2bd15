"""The machine for MuJoCo: it opens there, moves as ours does, weighs the same; too soft a loop is seen."""

from __future__ import annotations

import re
import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from conftest import ROOT
from hypothesis import given
from hypothesis import strategies as st
from judged import judged

import camgen
from camgen.errors import SpecError
from camgen.files import mjcf
from camgen.geometry.mesh import Mesh, placing
from camgen.machine.model import MM, Body, Spring
from camgen.machine.run import solve
from camgen.machines.loads.weights import with_masses
from camgen.machines.sources import read_mechanism
from camgen.parts.inertia import mass_moments, masses_together
from camgen.pipeline.multibody import simulated

# Error of a foot at 0.1 deg a step, mm [independent prototype on another walker, MuJoCo 4.0.1, `discrete`, 0.5 ms: 0.003]
ERROR = 0.003
# pins and a slot; gears with planets; slides; two slots
MACHINES = ["linkage", "quick-return", "planetary-reducer", "gallery/scotch-yoke", "gallery/beak"]


@cache
def machine(name: str) -> Any:
    mechanism = read_mechanism(ROOT / "specs" / f"{name}.toml").resolved()
    assembly = mechanism.assembly
    return assembly, with_masses(assembly.exact, assembly.solids, mechanism.load).machine, mechanism


@cache
def model(name: str) -> mjcf.Model:
    return simulated(machine(name)[2])


def opened(text: str) -> tuple[Any, Any]:
    """By MuJoCo, without the meshes, which only show."""
    bare = re.sub(r"<(geom [^>]*class=\"part\"|mesh )[^>]*/>", "", text)
    simulation = mujoco.MjModel.from_xml_string(bare)
    return simulation, mujoco.MjData(simulation)


def turned(simulation: Any, data: Any, motor: mjcf.Motor, turns: float, watch: Any) -> None:
    """From standstill, the drive slowly up to its speed; watch() after every twentieth step."""
    count = round((turns * 2 * np.pi / abs(motor.speed) + 0.3) / simulation.opt.timestep)
    for k in range(count):
        data.ctrl[0] = motor.control * min(1.0, data.time / 0.3)
        mujoco.mj_step(simulation, data)
        if k % 20 == 0:
            mujoco.mj_kinematics(simulation, data)
            watch()


def greatest_error(text: str, name: str, turns: float = 1.0) -> float:
    """Of places of all bodies against the machine closed at the same angle of the drive, mm; at its origin and 50 mm beside."""
    simulation, data = opened(text)
    assembly, exact, _ = machine(name)
    motor = model(name).motor
    names = [body.name for body in exact.moving]
    angles: list[float] = []
    places: list[Any] = []

    def watch() -> None:
        angles.append(data.joint(motor.joint).qpos[0])
        frame = data.body("ground").xmat.reshape(3, 3).T
        bodies = [data.body(each) for each in names]
        ends = [
            frame @ (body.xpos + body.xmat.reshape(3, 3) @ [x, 0, 0])
            for body in bodies
            for x in (0, 0.05)
        ]
        places.append([complex(x, y) / MM for x, y, _ in ends])

    turned(simulation, data, motor, turns, watch)
    rate = exact.drives[0].law(np.zeros(1), 1)[0]
    run = solve(exact, assembly.cycle.theta(np.zeros(1)) + np.array(angles) / rate, 0)
    ours = np.stack([run.point(each, x + 0j)[0] for each in names for x in (0, 50)], axis=1)
    assert angles[-1] / motor.speed > 0
    return float(np.max(np.abs(ours - np.array(places))))


@pytest.mark.parametrize("name", MACHINES)
def test_it_moves_as_ours(name: str) -> None:
    slow = replace(model(name), motor=replace(model(name).motor, stall=None))
    assert greatest_error(mjcf.text(slow), name) < ERROR


def test_soft_loops_are_seen() -> None:
    """With the softness that MuJoCo has where nobody says more."""
    text = re.sub(r'<equality solref="[^"]*" solimp="[^"]*" />', "", mjcf.text(model("linkage")))
    assert greatest_error(text, "linkage") > 5 * ERROR


@pytest.mark.parametrize("name", MACHINES)
def test_it_begins_closed_and_weighs_the_same(name: str) -> None:
    simulation, data = opened(mjcf.text(model(name)))
    _, weighed, _ = machine(name)
    mujoco.mj_kinematics(simulation, data)
    for kind, a, b in zip(
        simulation.eq_type, simulation.eq_obj1id, simulation.eq_obj2id, strict=True
    ):
        if kind == mujoco.mjtEq.mjEQ_CONNECT:
            apart = data.site_xpos[a] - data.site_xpos[b]
            assert np.hypot(*(data.body("ground").xmat.reshape(3, 3).T @ apart)[:2]) < 1e-9
    for body in weighed.moving:
        there = simulation.body(body.name)
        assert there.mass == pytest.approx(body.mass, rel=1e-9)
        axes = np.empty(9)
        mujoco.mju_quat2Mat(axes, there.iquat)
        tensor = axes.reshape(3, 3) @ np.diag(there.inertia) @ axes.reshape(3, 3).T
        assert tensor[2, 2] == pytest.approx(body.inertia, rel=1e-6)
        np.testing.assert_allclose(
            there.ipos[:2], MM * np.array([body.centre.real, body.centre.imag]), atol=1e-9
        )


def test_a_spring_stores_what_it_does_in_ours() -> None:
    """At standing still: k (l - free)^2 / 2, gravity aside."""
    tables = tomllib.loads((ROOT / "specs" / "linkage.toml").read_text(encoding="utf-8"))
    tables["points"]["S"] = [55, 110]
    tables["links"]["ground"] += ["S"]
    tables["spring"] = [{"between": ["B", "S"], "rate": 0.3, "free": 45}]
    sprung = read_mechanism(tables).resolved()
    weighed = sprung.model
    simulation, data = opened(mjcf.text(simulated(sprung)))
    simulation.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    simulation.opt.gravity[:] = 0
    mujoco.mj_forward(simulation, data)
    run = solve(weighed, np.zeros(1), 0)
    springs = [load for load in weighed.loads if isinstance(load, Spring)]
    stored = 0.0
    for spring in springs:
        ends = [run.point(place.body, place.at)[0, 0] for place in (spring.a, spring.b)]
        stored += spring.rate * (abs(ends[0] - ends[1]) - spring.free) ** 2 / 2 * MM
    assert springs and data.energy[0] == pytest.approx(stored, rel=1e-9)


def cuboid(size: Any) -> Mesh:
    """A block from the origin on."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * size
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    faces += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    return Mesh(corners.astype(float), np.array(faces))


LENGTH = st.floats(1, 100)


@given(size=st.tuples(LENGTH, LENGTH, LENGTH), angle=st.floats(-4, 4), cut=st.floats(0.1, 0.9))
def test_moments_of_a_block(size: Any, angle: float, cut: float) -> None:
    """m (b^2 + c^2) / 12 about its own axes, turned with it; and of two pieces of it together."""
    there = placing(angle, 3 - 4j, 5.0, size[2], flipped=True)
    whole = mass_moments(cuboid(size).moved(there), 1000.0)
    mass = 1e-6 * np.prod(size)
    squares = np.array(size) ** 2
    own = mass * np.diag(squares.sum() - squares) / 12
    turn = there[:, :3]
    assert whole.mass == pytest.approx(mass, rel=1e-9)
    np.testing.assert_allclose(whole.tensor, turn @ own @ turn.T, rtol=1e-9, atol=1e-9 * own.max())
    np.testing.assert_allclose(whole.centre, turn @ np.array(size) / 2 + there[:, 3], atol=1e-9)
    first = np.array([cut * size[0], *size[1:]])
    second = np.array([(1 - cut) * size[0], *size[1:]])
    shift = np.column_stack([np.eye(3), [first[0], 0, 0]])
    pieces = [cuboid(first).moved(there), cuboid(second).moved(shift).moved(there)]
    both = masses_together([mass_moments(each, 1000.0) for each in pieces])
    np.testing.assert_allclose(both.tensor, whole.tensor, rtol=1e-8, atol=1e-8 * own.max())


def test_a_body_in_the_plane_keeps_its_moments() -> None:
    body = Body("bar", mass=0.2, centre=3 + 4j, inertia=5e-6)
    fitted = mass_moments(cuboid((10, 20, 2)), 1000.0).fitted(body)
    assert fitted.mass == 0.2 and fitted.tensor[2, 2] == pytest.approx(5.0)
    assert list(fitted.centre) == [3, 4, 1]
    assert np.all(np.linalg.eigvalsh(fitted.second) > 0)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("mjcf")
    assert camgen.build(ROOT / "specs" / "linkage.toml", out, only="mjcf").ok
    return out / "linkage"


def test_a_folder_opens_and_is_judged(built: Path) -> None:
    simulation = mujoco.MjModel.from_xml_path(str(built / "mjcf" / "linkage.xml"))
    assert simulation.nmesh == len(list((built / "mjcf" / "meshes").iterdir())) > 3
    data = mujoco.MjData(simulation)
    mujoco.mj_kinematics(simulation, data)
    frame = data.body("ground").xmat.reshape(3, 3)
    copies = read_mechanism(built / "spec.toml").scene(0.0)
    for name in copies.graph.nodes_geometry:
        geom = simulation.geom(name)
        mesh = simulation.mesh(geom.dataid[0])
        first = mesh.vertadr[0]
        vertices = simulation.mesh_vert[first : first + mesh.vertnum[0]]
        there = vertices @ data.geom(name).xmat.reshape(3, 3).T + data.geom(name).xpos
        transform, part = copies.graph.get(name)
        ours = copies.geometry[part].copy().apply_transform(transform).bounds
        ends = there @ frame / MM
        np.testing.assert_allclose([ends.min(axis=0), ends.max(axis=0)], ours, atol=0.05)
    assert judged(built).ok
    text = (built / "mjcf" / "linkage.xml").read_text(encoding="utf-8")
    assert text == mjcf.text(simulated(read_mechanism(built / "spec.toml")))


def test_a_changed_folder_is_seen(built: Path) -> None:
    path = built / "mjcf" / "linkage.xml"
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace('kv="1"', 'kv="2"'), encoding="utf-8", newline="\n")
    assert {finding.code for finding in judged(built).findings if not finding.ok} == {"MANIFEST"}
    path.write_text(text, encoding="utf-8", newline="\n")


def test_a_cam_has_no_form(tmp_path: Path) -> None:
    spec = ROOT / "specs" / "gallery" / "valve.toml"
    with pytest.raises(SpecError, match="no form of contact"):
        camgen.build(spec, tmp_path, only="mjcf")
    assert not any(tmp_path.iterdir())
