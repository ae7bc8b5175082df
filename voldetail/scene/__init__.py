"""The scene: what a photo is of, the shape and the light, and how they are built for the renderer."""
