"""The checker of proof documents. It shares no code with the provers."""
