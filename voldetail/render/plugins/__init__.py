"""The renderer's plugins: the fitted reflectance and textures of colour."""
