"""Geometry without state: map, world and robot files, grids, polygons, rays, distances, and the one wrapper of numba."""
