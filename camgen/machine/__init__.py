"""The model of any planar machine and what follows from it: positions, derivatives, forces, freedoms, play."""
