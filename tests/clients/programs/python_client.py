"""The package ``safestart_client`` that openapi-python-client made of our OpenAPI 3.1 description."""

import json
import sys
import time

from safestart_client import Client
from safestart_client.api.jobs import get_status
from safestart_client.api.processes import execute
from safestart_client.api.results import get_result
from safestart_client.models import ExecuteBenchmark, Submitted

url, inputs = sys.argv[1], json.loads(sys.argv[2])
with Client(base_url=url) as client:
    request = ExecuteBenchmark.from_dict({"inputs": inputs})
    submitted = execute.sync("benchmark", client=client, body=request)
    assert isinstance(submitted, Submitted)
    while (status := get_status.sync(submitted.job_id, client=client).status) in ("accepted", "running"):
        time.sleep(0.2)
    result = get_result.sync(submitted.job_id, client=client)
print(f"{status}, {[row['code'] for row in result['outputs']['rows']]}")
