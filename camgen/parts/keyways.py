"""Keyways of hubs.   [DIN 6885 sheet 1, by berger-tools.co.uk, Standard_Parts_Catalogue, page 2078]"""

from __future__ import annotations

# Width and depth t2 of a hub's keyway and what t2 may be deeper, by the bores up to which they are, mm.
_KEYWAYS = (
    (8.0, 2.0, 1.0, 0.1),
    (10.0, 3.0, 1.4, 0.1),
    (12.0, 4.0, 1.8, 0.1),
    (17.0, 5.0, 2.3, 0.1),
    (22.0, 6.0, 2.8, 0.1),
    (30.0, 8.0, 3.3, 0.2),
    (38.0, 10.0, 3.3, 0.2),
    (44.0, 12.0, 3.3, 0.2),
)
_LEAST_KEYED = 6.0  # mm
RANGE = f"a bore of {_LEAST_KEYED:g} to {_KEYWAYS[-1][0]:g} mm, for which camgen has the keyway of DIN 6885"


def keyway(bore: float) -> tuple[float, float, float] | None:
    """Width and depth t2 of a hub's keyway, and by what it may be deeper, mm; None of a bore that has none in the table."""
    if bore < _LEAST_KEYED:
        return None
    return next((row[1:] for row in _KEYWAYS if bore <= row[0]), None)
