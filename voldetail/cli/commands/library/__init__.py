"""Libraries of procedural textures: built once, searched by a photo."""
