"""A machine as a picture that stands alone, such as those of the gallery."""

from __future__ import annotations

from html import escape

from camgen.report.animation import Animation, drawing
from camgen.report.colours import part_colour

_STYLE = (
    "svg{background:#fff;font-family:sans-serif}.upright{display:none}.grid{stroke:#e6eaee}.axes{stroke:#9aa5b1}.scale{stroke:#39424e}"
    "text{fill:#39424e}use{fill:currentColor;stroke:currentColor}"
)


def still_svg(animation: Animation, title: str, frame: int = 0) -> str:
    """A still picture of the mechanism at frame `frame`, as an SVG file of its own."""
    box, drawn = drawing(animation, frame)
    colours = "".join(f".c{k}{{color:{part_colour(k)}}}" for k in range(len(animation.bodies)))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="480" role="img">'
        f"<title>{escape(title)}</title><style>{_STYLE}{colours}</style>{drawn}</svg>\n"
    )
