"""Anyone's files: outlines from drawings, meshes, G-code, points and scans, laid on what was wanted; motion from them."""
