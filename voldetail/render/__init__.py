"""All that makes a picture: height field, traced mesh, marched and scattering volumes."""
