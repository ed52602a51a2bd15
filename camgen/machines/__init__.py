"""The mechanisms that camgen knows: one file each, named here once."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from camgen.machines.mechanism import Mechanism

MECHANISMS = {
    "disc-cam": "camgen.machines.disc_cam.mechanism:DiscCamDrive",
    "cylinder-cam": "camgen.machines.cylinder_cam.mechanism:CylinderCam",
    "drum": "camgen.machines.drum.mechanism:CamDrum",
    "linear-cam": "camgen.machines.linear_cam.mechanism:LinearCamDrive",
    "uniform-swing": "camgen.machines.uniform_swing.mechanism:UniformSwing",
    "thread-take-up": "camgen.machines.thread_take_up.mechanism:ThreadTakeUp",
    "eccentric-drive": "camgen.machines.eccentric_drive.mechanism:EccentricDrive",
    "indexing-cam": "camgen.machines.indexing_cam.mechanism:IndexingCam",
    "chain-stitch-looper": "camgen.machines.chain_stitch_looper.mechanism:ChainStitchLooper",
    "linkage": "camgen.machines.linkage.mechanism:Linkage",
    "coupon": "camgen.machines.coupon.mechanism:Coupon",
}


def load(name: str) -> type[Mechanism]:
    """The class of a mechanism in MECHANISMS; only its own module is imported."""
    module, _, cls = MECHANISMS[name].partition(":")
    mechanism_class: type[Mechanism] = getattr(import_module(module), cls)
    return mechanism_class
