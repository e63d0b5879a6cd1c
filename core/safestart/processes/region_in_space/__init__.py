"""The region-in-space process: slices of the starts that can stay, between proved polygons, answered at once."""
