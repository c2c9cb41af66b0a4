//! `posecut-multicut`: minimum-cost multicuts of landmark edges and of plain signed graphs.

fn main() -> std::process::ExitCode {
    posecut_multicut::command::main()
}
