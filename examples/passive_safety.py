"""Paper 003: the switched rendezvous with an abort between 120 and 125 minutes: is every abort passively safe?"""

import safestart as ss

result = ss.run(
    "passive-safety", {"abort_windows_min": [[120, 125]], "horizon_min": 240, "critical_abort": False}
)
for name, rows in result.tables().items():
    print(name)
    for row in rows[:5]:
        print(" ", {key: value for key, value in row.items() if value is not None})
assert result.pictures
