"""Files of the field: CCSDS messages, tables, and the records that they come to. Everything inside is in SI units."""
