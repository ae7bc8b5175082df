"""What a detail is at a point: relief, albedo, the shell about a shape, hypertexture, medium."""
