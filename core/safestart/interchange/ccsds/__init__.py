"""CCSDS navigation data messages: KVN and XML come apart into the same tokens, one file for each kind of message."""
