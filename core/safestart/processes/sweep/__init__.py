"""The sweep process: certificates against flown controllers over many starts."""
