"""The commands, by what they are about; each imports what it needs when it runs. A new one: a function here, its name below."""

from __future__ import annotations

from camgen.commands.building import build, check
from camgen.commands.designing import design
from camgen.commands.help import explain, guide_, list_, selftest
from camgen.commands.pages import explore, watch
from camgen.commands.precision import bench, tolerance
from camgen.commands.rolling import motion
from camgen.commands.simulating import simulate
from camgen.commands.specs import new, schema
from camgen.commands.sweeping import sweep

COMMANDS = (
    bench,
    build,
    check,
    design,
    explain,
    explore,
    guide_,
    list_,
    motion,
    new,
    schema,
    selftest,
    simulate,
    sweep,
    tolerance,
    watch,
)
