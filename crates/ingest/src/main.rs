//! `posecut-ingest`.

fn main() -> std::process::ExitCode {
    posecut_ingest::cli::main()
}
