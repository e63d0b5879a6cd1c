"""The package ``openapi_client`` that openapi-generator (python) made of our OpenAPI 3.0 description."""

import json
import sys
import time

from openapi_client import ApiClient, Configuration, JobsApi, ProcessesApi, ResultsApi
from openapi_client.models import BenchmarkInputs, ExecuteBenchmark, ExecuteRequest

url, inputs = sys.argv[1], json.loads(sys.argv[2])
with ApiClient(Configuration(host=url)) as client:
    request = ExecuteRequest(ExecuteBenchmark(inputs=BenchmarkInputs.from_dict(inputs)))
    job = ProcessesApi(client).execute("benchmark", request).job_id
    while (status := JobsApi(client).get_status(job).status.value) in ("accepted", "running"):
        time.sleep(0.2)
    result = ResultsApi(client).get_result(job)
print(f"{status}, {[row['code'] for row in result['rows']]}")
