// The package org.openapitools.client that openapi-generator (java, library native) made of our OpenAPI 3.0 description.

import com.fasterxml.jackson.databind.ObjectMapper;
import java.util.List;
import java.util.Map;
import java.util.stream.Collectors;
import org.openapitools.client.ApiClient;
import org.openapitools.client.api.JobsApi;
import org.openapitools.client.api.ProcessesApi;
import org.openapitools.client.api.ResultsApi;
import org.openapitools.client.model.BenchmarkInputs;
import org.openapitools.client.model.ExecuteBenchmark;
import org.openapitools.client.model.ExecuteRequest;

class Submit {
    public static void main(String[] arguments) throws Exception {
        ApiClient client = new ApiClient();
        client.updateBaseUri(arguments[0]);
        ObjectMapper json = ApiClient.createDefaultObjectMapper();
        BenchmarkInputs inputs = json.readValue(arguments[1], BenchmarkInputs.class);
        ExecuteRequest request = new ExecuteRequest(new ExecuteBenchmark().inputs(inputs));
        Object submitted = new ProcessesApi(client).execute("benchmark", request, null, null);
        String job = (String) ((Map<?, ?>) submitted).get("jobID");
        String status;
        while (true) {
            status = new JobsApi(client).getStatus(job, null).getStatus().getValue();
            if (!List.of("accepted", "running").contains(status)) break;
            Thread.sleep(200);
        }
        Object result = new ResultsApi(client).getResult(job, "ogc", null);
        List<?> rows = (List<?>) ((Map<?, ?>) result).get("rows");
        String codes = rows.stream().map(row -> (String) ((Map<?, ?>) row).get("code")).collect(Collectors.joining("', '"));
        System.out.println(status + ", ['" + codes + "']");
    }
}
