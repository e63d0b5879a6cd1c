// swagger-client (swagger-js), made of our description at run time.
import SwaggerClient from "swagger-client";

const [url, inputs] = process.argv.slice(2);
const { apis, spec } = await new SwaggerClient(`${url}/openapi.json`);
const requestBody = { inputs: JSON.parse(inputs) };
const { body: job } = await apis.processes.execute({ processID: "benchmark" }, { requestBody });
let status;
do {
  ({ body: { status } } = await apis.jobs.getStatus({ jobID: job.jobID, wait: 5 }));
} while (["accepted", "running"].includes(status));
const { body: result } = await apis.results.getResult({ jobID: job.jobID });
console.log(`OpenAPI ${spec.openapi}, ${status}, ${JSON.stringify(result.outputs.rows.map((row) => row.code))}`);
