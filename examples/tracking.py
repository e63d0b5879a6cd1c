"""Paper 002: a tracking MPC flies to the port of a tumbling target; its certificate, its region beside any impulses."""

import safestart as ss

result = ss.run("tracking-mpc", {"steps": 30, "region": {"rows": 6}}, progress=False)
for statement in result.outputs["statements"]:
    print(statement["statement"], statement["figure"])
print("under 5 cm after", result.outputs["time_to_5cm_s"], "s with", result.outputs["impulse_m_s"], "m/s")
flight = result.tables()["flight"]
assert flight[-1]["range_m"] < flight[0]["range_m"]
assert {"chaser.oem", "target.aem"} <= {
    one.name for one in result.artifacts
}  # the flight as files of the field
