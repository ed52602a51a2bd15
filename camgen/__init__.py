"""camgen: cam and linkage CAD geometry from a text spec, with the motion proved from the written files."""

__version__ = "0.1.0"
