"""The mechanisms that camgen knows: one file each, named here once."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from camgen.mechanism import Mechanism

MECHANISMS = {
    "disc-cam": "camgen.mechanisms.disc_cam:DiscCamDrive",
    "uniform-swing": "camgen.mechanisms.uniform_swing:UniformSwing",
    "thread-take-up": "camgen.mechanisms.thread_take_up:ThreadTakeUp",
    "eccentric-drive": "camgen.mechanisms.eccentric_drive:EccentricDrive",
    "indexing-cam": "camgen.mechanisms.indexing_cam:IndexingCam",
    "chain-stitch-looper": "camgen.mechanisms.chain_stitch_looper:ChainStitchLooper",
}


def load(name: str) -> type[Mechanism]:
    """The class of a mechanism in MECHANISMS; only its own module is imported."""
    module, _, cls = MECHANISMS[name].partition(":")
    found: type[Mechanism] = getattr(import_module(module), cls)
    return found
