"""Any planar machine from a spec: links, pins, slides, slots, gears, cams, a drive."""
