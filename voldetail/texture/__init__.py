"""Textures: how even they are, and tiles of them."""
