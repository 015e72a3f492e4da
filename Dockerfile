# An image that runs `sonarcal`, with nothing of what builds it:
#
#   docker build -t sonarcal .
#   docker run --rm -v "$PWD:/data" sonarcal inspect recording
FROM debian:12 AS build
COPY . /src
RUN /src/scripts/setup.sh \
    && apt-get install --yes --no-install-recommends dpkg-dev file \
    && cd /src/build \
    && cpack -G DEB --config CPackConfig.cmake -B /packages \
    && rm -rf /src/build /packages/_CPack_Packages

FROM debian:12-slim
RUN --mount=type=bind,from=build,source=/packages,target=/packages \
    apt-get update \
    && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends /packages/sonarcal_*.deb \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /data
ENTRYPOINT ["sonarcal"]
CMD ["--help"]
