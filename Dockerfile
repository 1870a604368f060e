# An image for a notebook hub or a shared machine; nothing else needs it. It runs as a user of its own, not as root.
#   docker build -t thermicon .
#   docker run --rm -p 127.0.0.1:8888:8888 thermicon
#   docker run --rm thermicon thermicon rank six-icons
FROM python:3.12-slim

RUN apt-get update \
    && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends gcc libc6-dev ngspice \
    && rm -rf /var/lib/apt/lists/*

COPY . /opt/thermicon
RUN pip install --no-cache-dir "/opt/thermicon[hardware,parquet,study]" jupyterhub

# The name and the number that hubs expect.
RUN useradd --create-home --uid 1000 jovyan \
    && install --directory --owner=jovyan --group=jovyan --mode=700 /opt/thermicon-cache
USER jovyan
WORKDIR /home/jovyan

# Compiled once into the image and outside the home, over which a hub mounts another, so that the first icon comes at
# once. Machine code is loaded from a folder only if no other user can write to it.
ENV THERMICON_CACHE=/opt/thermicon-cache
RUN thermicon rank six-icons --people 20 && thermicon doctor

RUN thermicon lab notebooks --files-only
EXPOSE 8888
# The server listens on the container's own address; its port is published on this machine alone, see above.
CMD ["jupyter", "lab", "--ip=0.0.0.0", "--no-browser", "notebooks"]
