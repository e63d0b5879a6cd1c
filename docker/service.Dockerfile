# The HTTP service: no engine, no JAX, no Dask; Numba for the exact answers.
FROM python:3.13-slim-trixie AS build
RUN pip install --no-cache-dir uv==0.13.9
WORKDIR /src
COPY pyproject.toml ./
COPY core core
COPY service service
COPY worker worker
ENV UV_PROJECT_ENVIRONMENT=/opt/safestart UV_LINK_MODE=copy UV_COMPILE_BYTECODE=1
RUN uv sync --no-dev --no-editable --package safestart-service

FROM python:3.13-slim-trixie
RUN useradd --system --uid 10001 --create-home safestart
COPY --from=build /opt/safestart /opt/safestart
# Compiled kernels: a volume, as the rest may be read-only, and filled here, so that the first answer need not wait.
RUN mkdir /var/cache/safestart && chown 10001 /var/cache/safestart
ENV PATH=/opt/safestart/bin:$PATH PYTHONUNBUFFERED=1 SAFESTART_LOG_FORMAT=json NUMBA_CACHE_DIR=/var/cache/safestart
USER 10001
RUN ["python", "-c", "from safestart.exact.kernels.warm import warm; warm()"]
VOLUME /var/cache/safestart
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=5s --start-period=20s --retries=3 \
    CMD ["python", "-c", "import urllib.request; urllib.request.urlopen('http://127.0.0.1:8000/healthz', timeout=4)"]
ENTRYPOINT ["safestart"]
CMD ["serve", "--host", "0.0.0.0"]
