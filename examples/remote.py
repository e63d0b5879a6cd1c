"""The same calls at a service: python examples/remote.py http://127.0.0.1:8000 [KEY]"""

import sys

import safestart as ss

url, key = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None
scenario = ss.Scenario.of(3.0, 0.1)
with ss.Client(url, key) as there:
    print(sorted(there.processes()))
    answer = there.decide(scenario, (5.0, 40.0))
    print(answer.verdict, answer.reason)
    print("\n".join(answer.verify().statement))  # the proof is checked here
    assert there.certify(scenario, [[5.0, 40.0]]).go.all()
    assert there.region(scenario).inner_area_m2 == ss.region(scenario).inner_area_m2
