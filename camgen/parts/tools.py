"""Tools that steps of assembly name, with what each is for, and what steps use up; in the order of the list of what to buy."""

USES = {
    "marker": "permanent, for names on parts that look alike",
    "caliper": "for lengths and gaps",
    "saw": "for rods of steel",
    "file": "for what is cut of steel, and for dowels that are too long",
    "scraper": "or a knife, for holes that are too tight",
    "vice": "for what is pressed into tight holes",
    "square": "a small one, for what must stand upright",
    "pliers": "small, for nuts and springs",
    "feeler gauges": "for gaps that steps set",
}
SUPPLIES = {
    "connectors": "two, or a soldering iron, for wires of motor and batteries",
    "double-sided tape": "for the battery holder and its wires",
    "adhesive tape": "for what must not fall out while you go on",
    "two-part glue": "such as epoxy, where steps name it: superglue sets too fast there, or does not bear the pressure",
    "oil": "a drop in joints beside glue",
    "grease": "a dot, for a spacer that would slip",
    "sheets of paper": "of 80 g, 0.1 mm each, for gaps that steps set",
    "plastic bag": "for the freezer, 0.05 mm thick, cut in strips for gaps that steps set",
}
