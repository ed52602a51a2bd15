"""The indexing cam with a spring unloader."""
