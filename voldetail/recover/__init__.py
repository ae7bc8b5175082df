"""The photo's own relief: height, normals, albedo and gloss of every pixel."""
