"""The trade-study process: what tumble rate and thrust allow."""
