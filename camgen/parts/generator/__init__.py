"""The generator: from a machine with its joints and the sizes of its bodies to the parts of an assembly."""
