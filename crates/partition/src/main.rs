//! `posecut-partition`.

fn main() -> std::process::ExitCode {
    posecut_partition::cli::main()
}
