"""Tools that steps of assembly name, with what each is for, and what steps use up; in the order of the list of what to buy."""

USES = {
    "marker": "permanent, for names on parts that look alike",
    "caliper": "for lengths and gaps",
    "saw": "for rods of steel",
    "file": "for steel that is too long, where a step names it",
    "scraper": "or a knife, for holes that are too tight",
    "fine sandpaper": "rolled round a thin rod, for holes for which you have no drill",
    "vice": "to press parts into tight holes",
    "square": "a small one, to set parts upright",
    "pliers": "small",
    "scissors": "for strips of a plastic bag",
    "thin stick": "such as a toothpick, for where no finger gets in",
    "feeler gauges": "to set the gaps that steps name",
}
SUPPLIES = {
    "connectors": "two, or a soldering iron, for the wires of motor and batteries",
    "double-sided tape": "for the battery holder and its wires",
    "adhesive tape": "to hold or pull parts while you work",
    "two-part glue": "such as slow epoxy or two-part acrylic glue, where a step asks for it: superglue sets too fast there, or does not bear the pressure",
    "oil": "a drop for each joint beside glue",
    "alcohol": "isopropyl, to wipe oil off what is glued",
    "adhesive putty": "such as Blu Tack, to hold what stands loose",
    "grease": "a dot, for a spacer that would slip",
    "sheets of paper": "80 g/m^2, 0.1 mm thick, to set the gaps that steps name",
    "plastic bag": "for the freezer, 0.05 mm thick, cut into strips to set the gaps that steps name",
}
