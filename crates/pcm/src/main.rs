//! `posecut-pcm`.

fn main() -> std::process::ExitCode {
    posecut_pcm::cli::main()
}
