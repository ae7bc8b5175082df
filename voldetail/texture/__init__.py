"""Textures by example: what a photo's colours are made of."""
