"""Threads of a linkage of parts: a post at each of their points, over all links.

post     pressed into its link or the plate, with a head; between that and a shoulder there is a groove
thread   lies in the grooves, all at one height
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from camgen.machine.features import Mount, Strand
from camgen.parts.catalogue import TURNED
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.pins import MountedPart
from camgen.parts.hardware import grooved, headed

HELD = 0.5  # of what a head and a shoulder stand out, which is enough to hold a thread


def thread_heights(layout: Layout) -> tuple[float, float]:
    """Between which heights threads lie on their posts, mm: their groove, up to the heads."""
    sizes = layout.sizes.thread_post_sizes
    top = round(layout.top(max(layout.level.values())) + sizes.height, 9)
    return top - (sizes.groove or sizes.height), top


def thread_posts(layout: Layout) -> Iterator[MountedPart]:
    """The posts of all threads."""
    head = layout.sizes.head
    sizes = layout.sizes.thread_post_sizes
    steel = sizes.made == "steel" or layout.sizes.of_sheet
    notes = ["pressed and glued in"]
    if sizes.groove:
        between = f"{sizes.groove:g} high, between head and shoulder"
        notes.append(f"the thread runs in the groove, {between}")
    for point, link in layout.thread_posts.items():
        foot = layout.floor(layout.level[link])
        wide = sizes.diameter_at(point)
        shape = wide, round(thread_heights(layout)[1] - foot, 9), wide + 2 * head, head
        post = headed("", "", *shape)
        if sizes.groove:
            post = grooved(post, sizes.groove)
        mount = Mount("", layout.carrier(link), layout.at(link, point), flipped=True, z=foot)
        made = TURNED if steel else "printed"
        yield replace(post, role="thread-post", notes=tuple(notes), process=made), mount


def strands(layout: Layout, posts: Sequence[Mount]) -> list[Strand]:
    """The threads; posts: all copies of their posts."""
    found = []
    for name, course in layout.threads.items():
        held = []
        for link, point in course:
            place = layout.carrier(link), layout.at(link, point)
            post = next(each for each in posts if (each.body, each.at) == place)
            copies = [each for each in posts if each.part == post.part]
            held.append((post.part, copies.index(post)))
        ends = *thread_heights(layout), HELD * layout.sizes.head
        found.append(Strand(name, tuple(held), *ends, layout.fits.slide_clearance))
    return found
