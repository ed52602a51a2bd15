"""The judge: files to shapes, contact, measured joints, clearances, findings; never what made a curve."""
