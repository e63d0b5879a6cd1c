"""CCSDS navigation data messages: KVN and XML share one form of tokens; one file for each kind of message."""
