"""At which angles an approach takes a wanted time or fuel."""
