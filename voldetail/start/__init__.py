"""Where a fit may start: reliefs rendered beforehand, whose pictures are compared with the photo's in a moment."""
