"""Paper 000: may this chaser start its approach? The certificate, the exact answer, its proof, the region."""

import safestart as ss

scenario = ss.Scenario.of(3.0, 0.1)  # deg/s, m/s²
starts = [(5.0, 40.0), (0.0, 149.0), (90.0, 20.0)]  # x, y in the body frame, m

quick = ss.certify(scenario, starts)
for start, verdict in zip(starts, quick.verdict, strict=True):
    print(start, "certificate:", verdict)

for start in starts:
    answer = ss.decide(scenario, start)
    print(start, "exact:", answer.verdict, "-", answer.reason)
    proved = answer.verify()
    assert proved.verdict == answer.verdict

region = ss.region(scenario)
print(f"proved GO: {region.inner_area_m2:.0f} m², between GO and NO_GO: "
      f"{region.outer_area_m2 - region.inner_area_m2:.0f} m²")  # fmt: skip
assert region.verdicts(starts[:2]).tolist() == ["GO", "NO_GO"]
