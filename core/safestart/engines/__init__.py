"""The reachability engines that check the certificate, one per file behind :mod:`safestart.engines.base`."""
