"""A procedural colour texture from one photo: endless, a few numbers."""
