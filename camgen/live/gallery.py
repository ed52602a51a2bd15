"""The linkages with which a sheet may begin, each with its picture."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

import numpy as np

from camgen import reading
from camgen.errors import CamgenError
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.linkage.traces import angles, traces
from camgen.machines.sources import changed


@dataclass(frozen=True)
class Gallery:
    """Texts of specs by their names, and a folder with a picture of some of them, NAME.svg."""

    texts: Mapping[str, str] = field(default_factory=dict)
    pictures: Path | None = None

    def pictured(self, name: str) -> bool:
        """Whether there is a picture of a spec."""
        return self.pictures is not None and (self.pictures / f"{name}.svg").is_file()


def usable(texts: Mapping[str, str]) -> dict[str, str]:
    """The texts of linkages that name no other file, by their names."""
    tables = {name: tomllib.loads(text) for name, text in texts.items()}
    return {
        name: texts[name]
        for name, data in tables.items()
        if data.get("mechanism") == "linkage" and not [*reading.references(data)]
    }


def cards(gallery: Gallery) -> str:
    """A button with a picture for each of them, as HTML: the gallery's own, with wheels and cams, or a sketch of the links."""
    buttons = []
    for name, text in gallery.texts.items():
        picture = f'<img src="pictures/{name}.svg" alt="" loading="lazy">'
        buttons.append(
            f'<button data-start="{name}">{picture if gallery.pictured(name) else _sketch(text)}<b>{name}</b>'
            f"<small>{escape(text.partition(chr(10))[0].lstrip('# '))}</small></button>"
        )
    return "".join(buttons)


def _sketch(text: str) -> str:
    """Links as drawn and the paths of the outputs, as SVG; an empty one where it does not move."""
    try:
        linkage = changed(tomllib.loads(text), "gallery", Path())
        assert isinstance(linkage, Linkage)
        found = traces(linkage, angles(linkage))
    except CamgenError:
        return "<svg></svg>"
    lines = [
        ("link", np.array([found[point][0] for point in points]))
        for link, points in linkage.links.items()
        if link != "ground"
    ]
    lines += [("path", found[each.point]) for each in linkage.wanted if each.point]
    every = np.concatenate([line for _, line in lines])
    size = 1.15 * max(np.ptp(every.real), np.ptp(every.imag), 1.0)
    corner = [(z.max() + z.min() - size) / 2 for z in (every.real, -every.imag)]
    drawn = []
    for kind, line in lines:
        x, y = (
            100 * (z - low) / size for z, low in zip((line.real, -line.imag), corner, strict=True)
        )
        places = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        drawn.append(f'<polyline class="{kind}" points="{places}"/>')
    return f'<svg viewBox="0 0 100 100" aria-hidden="true">{"".join(drawn)}</svg>'
