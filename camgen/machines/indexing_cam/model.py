"""The machine of an indexing cam, drawn and on its bench: cam, follower, driven link, what turns and unloads it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from camgen.machine.cams.machine import FollowerLoad, cam_machine
from camgen.machine.model import GROUND, Angle, Body, Gear, Machine, Output, Pin, Place, Resistance
from camgen.machine.model import Pose as Start
from camgen.machines.bench import Bench
from camgen.machines.indexing_cam.driver import ARM
from camgen.machines.indexing_cam.standing_driver import StandingDriver
from camgen.machines.indexing_cam.standing_unloader import CRANK, StandingUnloader
from camgen.machines.indexing_cam.stepping import WHEEL, Stepping
from camgen.machines.indexing_cam.unloader import CrankSpring, OnLink
from camgen.machines.standing import Sizes
from camgen.parts.catalogue import CLUTCHES
from camgen.parts.generator.wheels import Ridden
from camgen.parts.inertia import printed_density

if TYPE_CHECKING:
    from camgen.machines.indexing_cam.mechanism import IndexingCam

LINK = "driven-link"
_MARK = 0.8  # of the table's radius, to the hole that shows how it stands


def stepping(spec: IndexingCam) -> Stepping | None:
    """How the link turns on; None where it goes to and fro."""
    if spec.freewheel is None:
        return None
    g, start = spec.geometry, spec.cam_drive.start["follower"].angle
    return Stepping(
        spec.program,
        math.radians(g.rise_deg),
        g.gear_ratio,
        math.radians(g.index_deg),
        math.radians(spec.freewheel.lost_deg),
        -1 if spec.cam_drive.speed < 0 else 1,
        -g.gear_ratio * start,
        CLUTCHES[spec.sizes.shaft_diameter][1],
    )


def cam_drive(spec: IndexingCam, closing: float) -> Machine:
    """Cams and follower, with the chain before them; closing: torque of a spring, N m."""
    closed: Literal["form", "force"] = "force" if spec.geometry.closure == "force" else "form"
    pressed = FollowerLoad(spec.load.follower_inertia_kg_m2, preload=closing)
    speed = spec.motor.speed_rpm * math.tau / 60
    drive = cam_machine([*spec.cams.values()], speed, pressed, closed)
    return drive if spec.two_cranks is None else spec.two_cranks.before(drive)


def made_unloader(spec: IndexingCam) -> StandingUnloader | None:
    """The unloader of a machine that is made; None where its spring is none that can be."""
    if not isinstance(spec.unloading, CrankSpring):
        return None
    f, ratio = spec.geometry.follower, spec.geometry.gear_ratio
    wheel = (spec.link_centre.real - f.pivot_distance) * ratio / (1 + ratio)
    return StandingUnloader(
        spec.unloading,
        spec.link_centre,
        f.arm / 2,
        wheel,
        [*spec.cams.values()],
        spec.swing,
        spec.sizes,
    )


def drawn(spec: IndexingCam, closing: float, unloaded: bool = True) -> Machine:
    """The model; unloaded: whether with the unloader's torque, as no part gives it.

    Outputs "swing" of the follower and "link", rad, and of a link that turns on "wheel", which turns it.
    """
    drive, ratio, step = cam_drive(spec, closing), -spec.geometry.gear_ratio, spec.stepping
    link, geared = Body(LINK, inertia=spec.load.inertia_kg_m2), LINK if step is None else WHEEL
    turns = ratio * drive.start["follower"].angle
    way = ratio * spec.swing if step is None else -step.index
    spring = None if spec.unloading is None or not unloaded else OnLink(spec.unloading, way)
    borne = Resistance(
        "unloader and friction", Angle(LINK), friction=spec.load.friction_n_m, law=spring
    )
    bodies, joints, outputs = (
        [link],
        [Pin("link's axle", Place(LINK), Place(GROUND, spec.link_centre))],
        [],
    )
    if step is not None:
        bodies.append(Body(WHEEL))
        joints.append(Pin("wheel's axle", Place(WHEEL), Place(GROUND, spec.link_centre)))
        outputs.append(Output("wheel", Angle(WHEEL), "rad"))
    return replace(
        drive,
        bodies=(*drive.bodies, *bodies),
        joints=(
            *drive.joints,
            *joints,
            Gear("gears", "follower", geared, ratio),
            *([] if step is None else [step.clutch(LINK)]),
        ),
        start={
            **drive.start,
            **{body.name: Start(spec.link_centre, turns) for body in bodies},
            **({} if step is None else {LINK: Start(spec.link_centre, 0.0)}),
        },
        loads=(*drive.loads, borne),
        outputs=(*drive.outputs, Output("link", Angle(LINK), "rad"), *outputs),
    )


def stood(spec: IndexingCam) -> Bench:
    """On the bench the driven link is a round table."""
    density = printed_density(spec.material)
    f, load, made = spec.geometry.follower, spec.load, spec.made_unloader
    shapes: dict[str, object] = {LINK: {"hub_diameter": f.arm}}
    freewheels = {}
    points: dict[str, dict[str, complex]] = {GROUND: {"axle": spec.link_centre}, LINK: {"axle": 0j}}
    if spec.freewheel is not None:
        clutch, _ = CLUTCHES[spec.sizes.shaft_diameter]
        points[WHEEL], freewheels = {"axle": 0j}, {WHEEL: (LINK, clutch)}
        shapes[WHEEL] = {"thickness": clutch.width}
    sizes = Sizes.model_validate({**shapes, **spec.sizes.model_dump(exclude_none=True)})
    gears: dict[str, int | None] = {"gears": None}
    machine, strung, driven, beneath = drawn(spec, 0.0), {}, "cam", None
    if spec.two_cranks is not None:
        driven, points[GROUND]["arm"], points[ARM] = ARM, spec.two_cranks.at, {"arm": 0j}
        gears["2 to 1"] = None
        shafts = [
            0j,
            complex(f.pivot_distance),
            spec.link_centre,
            *([] if made is None else [made.axle]),
        ]
        beneath = StandingDriver(machine, sizes, spec.print, spec.allowed.min_wall, density, shafts)
    if made is not None:
        machine, gears["unloader gears"] = made.added(drawn(spec, 0.0, False), LINK), None
        points[GROUND] |= {"crank": made.axle, "anchor": made.post}
        points[CRANK] = {"crank": 0j, "hook": made.hook(machine.start_of(CRANK).angle)}
        strung = {"unloader_spring": made.strung()}
    g = spec.geometry
    tip = Ridden(
        "roller",
        f.roller_radius,
        g.closure,
        tip_clearance=g.tip_clearance,
        limits=spec.allowed.cam_limits,
    )
    return Bench(
        machine,
        spec.cams["cam"],
        tip,
        sizes,
        spec.print,
        spec.allowed.min_wall,
        density,
        FollowerLoad(preload=load.closing_n_m),
        [LINK, *(["follower"] if load.follower_inertia_kg_m2 else [])],
        gears,
        points,
        strung,
        freewheels=freewheels,
        driven=driven,
        beneath=beneath,
        marks={} if spec.freewheel is None else {LINK: complex(_MARK * f.arm / 2)},
    )
