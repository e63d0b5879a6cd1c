"""Commands that read and write files of the field."""
