"""The exact questions and their answers, with evidence: thrust for GO, multipliers for NO_GO."""
