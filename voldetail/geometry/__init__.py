"""Shapes before any relief: primitives, mesh files, tessellation, signed distances, iso-surfaces, grids."""
