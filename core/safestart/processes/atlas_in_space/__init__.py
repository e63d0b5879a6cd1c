"""The atlas-in-space process: proved polygons of the starts that can stay, in planes in space."""
