"""The trade-study process: the effect of tumble rate and thrust."""
