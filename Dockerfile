# All programs in one file: docker build -t posecut . && docker run --rm -v "$PWD:/data" posecut clean graph.g2o -o clean.g2o
FROM rust:1.95-slim-trixie AS build
WORKDIR /posecut
COPY . .
RUN cargo install --path crates/posecut --locked --root /usr/local

FROM debian:trixie-slim
COPY --from=build /usr/local/bin/posecut /usr/local/bin/
WORKDIR /data
ENTRYPOINT ["posecut"]
CMD ["help"]
