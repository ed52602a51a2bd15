"""The card of a law, as the source prints it: a, b, c over the run-up, and both curves, c and the balancing effort P = Y G.

The unloader of MR-13's card is a spring on a cord from a crank pin: crank r, cord over a guide at lambda r from the crank's
axle, stretched by x0 r where pin and guide are nearest, gamma past the dead centre at the start. G is its torque on the link
in units of stiffness times r^2, over the share a of the stroke; Y the factor that brings it nearest to c.
"""

from __future__ import annotations

import math

import numpy as np

from camgen.machines.indexing_cam.unloader import CrankSpring
from camgen.motion.laws import Floats, Law
from camgen.numerics import magnitude
from camgen.study import Figure, Plot, Table, figures_in

# printed with MR-13; 0.3141592 is pi / 10 cut off
GAMMA = math.pi / 10
LAMBDA = 4.0
X0 = 0.2
Y = 4.640648
ROWS = 31  # z = 0 to 30


def effort(a: Floats) -> Floats:
    """P = Y G at a share a of the stroke, (n,), in the units of c."""
    unit = CrankSpring(
        1e3, 1.0, LAMBDA, X0, GAMMA, 2 * (math.pi - GAMMA)
    )  # N/mm, mm: its torque in N m is G
    return np.asarray(Y * unit(np.asarray(a, float)))


def card(law: Law) -> tuple[Table, list[Plot], list[Figure]]:
    """Table of the law's 31 rows, of MR-13 with P in it, the plot of both curves, and the printed parameters as figures."""
    z = np.arange(ROWS)
    kappa = z / (2 * (ROWS - 1))
    columns = ["z", "a", "b", "c", "b c"]
    values = [np.round(law(kappa, order), 12) for order in range(3)]
    values.append(values[1] * values[2])
    if law.name != "mr-13":
        return _table(columns, z, values), [], []
    columns.append("P = Y G")
    values.append(effort(values[0]))
    whole = np.arange(2 * ROWS - 1) / (2 * (ROWS - 1))  # the source's peaks are those of its table
    apart = effort(law(whole)) - law(whole, 2)
    peak = magnitude(effort(law(whole)))
    fine = np.linspace(0, 1, 601)
    c = law(fine, 2)
    p = effort(law(fine))
    curves = [("c, the law", fine, c), ("P = Y G, the unloader", fine, p)]
    printed = [
        Figure("card gamma", math.degrees(GAMMA), "deg"),
        *figures_in(
            card_lambda_ratio=LAMBDA,
            card_x0_ratio=X0,
            card_y_ratio=Y,
            card_effort_start_ratio=float(p[0]),
            card_effort_peak_ratio=peak,
            card_difference_max_ratio=magnitude(apart),
        ),
    ]
    return (
        _table(columns, z, values),
        [Plot("Card of the law MR-13", "kappa = t / T", "c, P", curves)],
        printed,
    )


def _table(columns: list[str], z: np.ndarray, values: list[Floats]) -> Table:
    rows = [[int(z[k]), *(float(v[k]) for v in values)] for k in range(ROWS)]
    return Table(f"Position invariants over the run-up, kappa = z/{2 * (ROWS - 1)}", columns, rows)
