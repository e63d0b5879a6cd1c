"""Paper 001: the avoid game of two satellites on a coarse grid; the worst encounters as a table."""

import safestart as ss

result = ss.run(
    "collision-avoidance",
    {
        "encounters": 10,
        "supervised": 0,
        "horizon_s": 30,
        "capture_horizon_s": 100,
        "pilots": ["certified"],
        "adversaries": ["worst"],
        "grid": {"nodes_position": 11, "nodes_speed": 7},
        "states": [[300, 50, -3, -1], [110, 5, -4, 0]],
    },
)
for name, rows in result.tables().items():
    print(name, len(rows), "rows")
print({name: value for name, value in result.outputs.items() if isinstance(value, float | int | str)})
